// The reference page of a schema, in Markdown.
#include <algorithm>

#include "core/describe_schema.hpp"

namespace jaxmpm::described {
namespace {

std::string quoted(const Json& value) {
  return "`" +
         (value.is_string() ? "\"" + value.get<std::string>() + "\""
                            : (value.is_number() ? shown_number(value.get<double>()) : value.dump())) +
         "`";
}

std::string joined(const Json& list, const char* separator, std::string (*text)(const Json&)) {
  std::string out;
  for (const Json& item : list) out += (out.empty() ? "" : separator) + text(item);
  return out;
}

std::string anchor(std::string name) {
  name.erase(std::remove(name.begin(), name.end(), '.'), name.end());
  return "#" + name;
}

std::string type_text(const Json& type);
std::string plural(const Json& type);

std::string object_text(const Json& type) {
  if (type.contains("properties") && type["properties"].size() == 1) {
    const auto only = type["properties"].begin();
    return "`{\"" + only.key() + "\": …}` with " + type_text(only.value());
  }
  if (type.contains("properties")) {
    std::string keys;
    for (const auto& [name, value] : type["properties"].items()) keys += (keys.empty() ? "`" : ", `") + name + "`";
    return "object of " + keys;
  }
  return "object of named values: " + type_text(type["additionalProperties"]);
}

std::string count_text(const Json& type) {
  if (type.contains("x-length")) return ", " + type["x-length"].get<std::string>();
  const bool least = type.contains("minItems"), most = type.contains("maxItems");
  if (least && most && type["minItems"] == type["maxItems"]) return ", " + type["minItems"].dump() + " of them";
  if (least && most) return ", " + type["minItems"].dump() + " to " + type["maxItems"].dump() + " of them";
  return least ? ", at least " + type["minItems"].dump() : std::string();
}

std::string range_text(const Json& type) {
  std::string text;
  for (const auto& [key, words] :
       {std::pair{"exclusiveMinimum", "> "}, std::pair{"minimum", "≥ "}, std::pair{"exclusiveMaximum", "< "}, std::pair{"maximum", "≤ "}})
    if (type.contains(key)) text += (text.empty() ? " " : ", ") + std::string(words) + shown_number(type[key].get<double>());
  return text;
}

std::string type_text(const Json& type) {
  if (type.contains("$ref")) {
    const std::string name = type["$ref"].get<std::string>().substr(8);
    return "[" + name + "](" + anchor(name) + ")";
  }
  if (type.contains("const")) return quoted(type["const"]);
  if (type.contains("enum")) return joined(type["enum"], ", ", quoted);
  for (const char* forms : {"oneOf", "anyOf"})
    if (type.contains(forms)) return joined(type[forms], " or ", type_text);
  const std::string kind = type["type"];
  if (kind == "array") return "list of " + plural(type["items"]) + count_text(type);
  if (kind == "object") return object_text(type);
  return (kind == "integer" ? "whole number" : kind == "boolean" ? "true or false" : kind) + range_text(type);
}

std::string plural(const Json& type) {
  const std::string text = type_text(type);
  for (const std::string word : {"whole number", "number", "string"})
    if (text.compare(0, word.size(), word) == 0) return word + "s" + text.substr(word.size());
  return text;
}

std::string default_text(const Json& type, bool required) {
  if (required) return "required";
  if (type.contains("x-default")) return type["x-default"];
  return type.contains("default") ? quoted(type["default"]) : "";
}

std::string row(const std::string& name, const Json& type, bool required) {
  std::string prose = type.value("description", "");
  if (type.contains("x-only-with"))
    prose += (prose.empty() ? "" : " ") + std::string("Only with ") + type["x-only-with"].get<std::string>() + ".";
  return "| `" + name + "` | " + type_text(type) + " | " + type.value("x-unit", "") + " | " + default_text(type, required) + " | " + prose +
         " |\n";
}

std::string table(const Json& type) {
  std::string text = "| key | value | unit | default | meaning |\n|---|---|---|---|---|\n";
  const Json required = type.value("required", Json::array());
  for (const auto& [name, key] : type["properties"].items())
    text += row(name, key, std::find(required.begin(), required.end(), Json(name)) != required.end());
  return text;
}

std::string forms(const Json& type) {
  std::string text;
  for (const char* key : {"oneOf", "anyOf"})
    for (const Json& form : type.value(key, Json::array()))
      text += "- " + type_text(form) + (form.contains("description") ? ": " + form["description"].get<std::string>() : "") + "\n";
  return text;
}

}  // namespace

std::string reference_markdown(const Json& schema) {
  std::string text =
      "# Reference of the deck\n\nGenerated from the descriptions that the reader itself uses (lib/deck/describe_*.cpp); a test keeps it "
      "up to date.\n";
  for (const auto& [name, type] : schema["$defs"].items()) {
    text += "\n## " + name + "\n\n";
    if (type.contains("description"))
      text += type["description"].get<std::string>() +
              (type.contains("x-dimension") ? " Only in " + type["x-dimension"].dump() + "D." : "") + "\n\n";
    if (!type.contains("properties")) text += forms(type);
    else if (!type["properties"].empty()) text += table(type);
    else text += "No keys.\n";
  }
  return text;
}

}  // namespace jaxmpm::described
