// Structs read, written and described by what is known of their keys.
#include "core/describe.hpp"

namespace jaxmpm::described {
namespace {

void* member(void* out, const KeyFacts& key) { return static_cast<char*>(out) + key.offset; }
const void* member(const void* in, const KeyFacts& key) { return static_cast<const char*>(in) + key.offset; }

void check_fixed(const Json& value, const Place& place) {
  if (value.is_null() ? !place.value.is_string() : place.value != value)
    place.problem("expected " + (value.is_null() ? std::string("a string") : value.dump()) + ", found " + shown(place.value));
}

void read_key(const KeyFacts& key, void* out, const Place& place) {
  if (key.codec == nullptr) check_fixed(key.fixed, place);
  else key.codec->read(member(out, key), place, key.limits);
}

Json write_key(const KeyFacts& key, const void* in) {
  if (key.codec != nullptr) return key.codec->write(member(in, key), key.limits);
  return key.fixed.is_null() ? Json(Json::value_t::discarded) : key.fixed;
}

Json type_schema(const KeyFacts& key, Schema& defs) {
  if (key.codec != nullptr) return key.codec->schema(key.limits, defs);
  return key.fixed.is_null() ? Json{{"type", "string"}} : Json{{"const", key.fixed}};
}

/// Schema of one key: range from the type, prose, unit, default and condition as annotations.
Json key_schema(const KeyFacts& key, const void* fresh, Schema& defs) {
  Json type = type_schema(key, defs);
  if (!key.text.empty()) type["description"] = key.text;
  if (!key.limits.unit.empty()) type["x-unit"] = key.limits.unit;
  if (key.limits.length == Limits::Length::dimension) type["x-length"] = "one per axis";
  if (key.limits.length == Limits::Length::plan) type["x-length"] = "one per horizontal axis";
  const bool has_default = !key.required && key.default_text.empty();
  if (const Json value = has_default ? write_key(key, fresh) : Json(Json::value_t::discarded); !value.is_discarded())
    type["default"] = value;
  if (!key.default_text.empty()) type["x-default"] = key.default_text;
  if (!key.condition.empty()) type["x-only-with"] = key.condition;
  return type;
}

}  // namespace

void StructDescription::is(std::string name, std::string prose, const std::string& family) {
  definition_ = family.empty() ? name : family + "." + name;
  name_ = std::move(name);
  text_ = std::move(prose);
}

KeyFacts& StructDescription::add(const std::string& name, const ValueCodec& codec, std::ptrdiff_t offset, bool required) {
  KeyFacts& key = keys_.emplace_back();
  key.name = name;
  key.codec = &codec;
  key.offset = offset;
  key.required = required;
  return key;
}

void StructDescription::fixed(const std::string& name, Json value, bool needed, const std::string& prose) {
  KeyFacts& key = keys_.emplace_back();
  key.name = name;
  key.required = needed;
  key.text = prose;
  key.fixed = std::move(value);
}

std::vector<std::string> StructDescription::names(const std::string& tag) const {
  std::vector<std::string> list;
  if (!tag.empty()) list.push_back(tag);
  for (const KeyFacts& key : keys_) list.push_back(key.name);
  return list;
}

void StructDescription::read_keys(void* out, const Place& place) const {
  for (const KeyFacts& key : keys_) {
    if (place.given(key.name)) read_key(key, out, place.key(key.name));
    else if (key.required) place.problem(key.name, "is missing" + (key.text.empty() ? std::string() : "; it gives: " + key.text));
  }
  for (const KeyFacts& key : keys_)
    if (!place.given(key.name) && key.fill) key.fill(out, place.reader);
}

void StructDescription::read_struct(void* out, const Place& place, const std::string& tag) const {
  if (dimension_ != 0 && place.reader.dimension() != 0 && place.reader.dimension() != dimension_)
    return place.problem(name_ + " exists only in " + std::to_string(dimension_) + "D; the domain is " +
                         std::to_string(place.reader.dimension()) + "D: choose another");
  if (!check_object(place)) return;
  read_keys(out, place);
  check_together(out, place);
  check_keys(place, names(tag));
}

void StructDescription::check_together(const void* out, const Place& place) const {
  for (const KeyFacts& key : keys_)
    if (key.matters && place.given(key.name) && place.sound(key.matters_by) && !key.matters(out))
      place.problem(key.name, "has no effect here, only with " + key.condition + "; remove it");
  for (const auto& [by, rule] : rules_)
    if (place.sound(by)) rule(out, place);
}

Json StructDescription::write_struct(const void* in, const std::string& tag) const {
  Json object = Json::object();
  if (!tag.empty()) object[tag] = name_;
  for (const KeyFacts& key : keys_) {
    if (key.matters && !key.matters(in)) continue;
    Json value = write_key(key, in);
    if (!value.is_discarded() && !(key.empty_is_absent && (value.empty() || value == ""))) object[key.name] = std::move(value);
  }
  return object;
}

Json StructDescription::struct_schema(const void* fresh, Schema& defs, const std::string& tag) const {
  Json schema{{"type", "object"}, {"title", definition_}, {"description", text_}};
  if (dimension_ != 0) schema["x-dimension"] = dimension_;
  Json properties = Json::object(), required = Json::array();
  if (!tag.empty()) {
    properties[tag] = {{"const", name_}};
    required.push_back(tag);
  }
  for (const KeyFacts& key : keys_) {
    properties[key.name] = key_schema(key, fresh, defs);
    if (key.required) required.push_back(key.name);
  }
  schema["properties"] = std::move(properties);
  if (!required.empty()) schema["required"] = std::move(required);
  schema["additionalProperties"] = false;
  return schema;
}

}  // namespace jaxmpm::described
