#pragma once
// Bodies of Description<T>; included by describe.hpp alone.
#include "core/describe.hpp"

namespace jaxmpm::described {

/// Whether the value is an object; reports if not.
bool check_object(const Place& place);
/// Reports keys that are not among `names`, with the nearest of them.
void check_keys(const Place& place, const std::vector<std::string>& names);
/// Schema of one key: range from the type, prose, unit, default and condition as annotations.
Json key_schema(Json type, const std::string& help, const Limits& limits, const Json& default_value, const std::string& default_text,
                const std::string& condition);
Json object_schema(const std::string& title, const std::string& text, int dimension, Json properties, Json required);

template <class T>
template <class C, class M>
Key<T>& Description<T>::add(const std::string& name, M T::*member, bool required) {
  Key<T>& key = keys_.emplace_back();
  key.name = name;
  key.required = required;
  key.read = [member](T& out, const Place& place, const Limits& limits) { C::read(out.*member, place, limits); };
  key.write = [member](const T& in, const Limits& limits) { return C::write(in.*member, limits); };
  key.schema = [](const Limits& limits, Schema& defs) { return C::schema(limits, defs); };
  return key;
}

template <class T>
void Description<T>::fixed(const std::string& name, Json value, bool needed, const std::string& prose) {
  Key<T>& key = keys_.emplace_back();
  key.name = name;
  key.required = needed;
  key.text = prose;
  key.read = [value](T&, const Place& place, const Limits&) {
    if (value.is_null() ? !place.value.is_string() : place.value != value)
      place.problem("expected " + (value.is_null() ? std::string("a string") : value.dump()) + ", found " + shown(place.value));
  };
  key.write = [value](const T&, const Limits&) { return value.is_null() ? Json(Json::value_t::discarded) : value; };
  key.schema = [value](const Limits&, Schema&) { return value.is_null() ? Json{{"type", "string"}} : Json{{"const", value}}; };
}

template <class T>
std::vector<std::string> Description<T>::names(const std::string& tag) const {
  std::vector<std::string> list;
  if (!tag.empty()) list.push_back(tag);
  for (const Key<T>& key : keys_) list.push_back(key.name);
  return list;
}

template <class T>
void Description<T>::read_keys(T& out, const Place& place) const {
  for (const Key<T>& key : keys_) {
    if (place.given(key.name)) key.read(out, place.key(key.name), key.limits);
    else if (key.required) place.problem(key.name, "is missing" + (key.text.empty() ? std::string() : "; it gives: " + key.text));
  }
  for (const Key<T>& key : keys_)
    if (!place.given(key.name) && key.fill) key.fill(out, place.reader);
}

template <class T>
void Description<T>::read(T& out, const Place& place, const std::string& tag) const {
  if (dimension_ != 0 && place.reader.dimension() != 0 && place.reader.dimension() != dimension_)
    return place.problem(name_ + " exists only in " + std::to_string(dimension_) + "D; the domain is " +
                         std::to_string(place.reader.dimension()) + "D: choose another");
  if (!check_object(place)) return;
  read_keys(out, place);
  check_together(out, place);
  check_keys(place, names(tag));
}

template <class T>
void Description<T>::check_together(const T& out, const Place& place) const {
  for (const Key<T>& key : keys_)
    if (key.matters && place.given(key.name) && place.sound(key.matters_by) && !key.matters(out))
      place.problem(key.name, "has no effect here, only with " + key.condition + "; remove it");
  for (const auto& [by, rule] : rules_)
    if (place.sound(by)) rule(out, place);
}

template <class T>
Json Description<T>::write(const T& in, const std::string& tag) const {
  Json object = Json::object();
  if (!tag.empty()) object[tag] = name_;
  for (const Key<T>& key : keys_) {
    if (key.matters && !key.matters(in)) continue;
    Json value = key.write(in, key.limits);
    if (!value.is_discarded() && !(key.empty_is_absent && (value.empty() || value == ""))) object[key.name] = std::move(value);
  }
  return object;
}

template <class T>
Json Description<T>::schema(Schema& defs, const std::string& tag) const {
  Json properties = Json::object(), required = Json::array();
  if (!tag.empty()) {
    properties[tag] = {{"const", name_}};
    required.push_back(tag);
  }
  const T fresh{};
  for (const Key<T>& key : keys_) {
    const Json default_value = key.required || !key.default_text.empty() ? Json(Json::value_t::discarded) : key.write(fresh, key.limits);
    properties[key.name] = key_schema(key.schema(key.limits, defs), key.text, key.limits, default_value, key.default_text, key.condition);
    if (key.required) required.push_back(key.name);
  }
  return object_schema(definition_, text_, dimension_, std::move(properties), std::move(required));
}

// ---- one of several structs ----

/// Codec of a std::variant of described structs that are told apart by a tag among their own keys, as {"model": "newtonian", …}.
template <class V>
struct Tagged;
template <class... Ts>
struct Tagged<std::variant<Ts...>> {
  using V = std::variant<Ts...>;
  static std::vector<std::string> words() { return {Description<Ts>::get().name()...}; }

  static void read(V& out, const Place& place, const std::string& tag) {
    if (!place.value.is_object()) return place.problem("expected an object, found " + shown(place.value));
    if (!place.given(tag)) return place.problem(tag, "is missing; choose one of: " + listed(words()));
    const int index = read_choice(place.key(tag), words());
    int k = 0;
    ((k++ == index ? Description<Ts>::get().read(out.template emplace<Ts>(), place, tag) : void()), ...);
  }
  static Json write(const V& in, const std::string& tag) {
    return std::visit([&tag](const auto& one) { return Description<std::decay_t<decltype(one)>>::get().write(one, tag); }, in);
  }
  static Json schema(Schema& defs, const std::string& tag) {
    Json list = Json::array();
    (list.push_back(defs.reference(Description<Ts>::get().definition(), [&] { return Description<Ts>::get().schema(defs, tag); })), ...);
    return {{"oneOf", list}};
  }
};

/// Reports unless the object has exactly one key and it is one of `words`; returns that key's index or −1.
int read_only_key(const Place& place, const std::vector<std::string>& words);
Json only_key_schema(const std::string& name, Json value, const std::string& text = {});

/// Codec of a std::variant of described structs that are told apart by the only key of an object around them, as {"box": {…}}.
template <class V>
struct Keyed;
template <class... Ts>
struct Keyed<std::variant<Ts...>> {
  using V = std::variant<Ts...>;
  static std::vector<std::string> words() { return {Description<Ts>::get().name()...}; }

  static void read(V& out, const Place& place) {
    const int index = read_only_key(place, words());
    int k = 0;
    ((k++ == index ? Codec<Ts>::read(out.template emplace<Ts>(), place.key(Description<Ts>::get().name()), {}) : void()), ...);
  }
  static Json write(const V& in) {
    return std::visit(
        [](const auto& one) {
          using T = std::decay_t<decltype(one)>;
          return Json{{Description<T>::get().name(), Codec<T>::write(one, {})}};
        },
        in);
  }
  static Json schema(Schema& defs) {
    Json list = Json::array();
    (list.push_back(only_key_schema(Description<Ts>::get().name(), Codec<Ts>::schema({}, defs), Description<Ts>::get().text())), ...);
    return {{"oneOf", list}};
  }
};

}  // namespace jaxmpm::described
