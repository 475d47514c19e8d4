#include "core/describe.hpp"

#include <algorithm>
#include <cmath>

namespace jaxmpm::described {
namespace {

/// No quantity of a scene is larger (SI units); beyond it squares and products would overflow in single precision or be meaningless.
constexpr double largest_number = 1e30;

std::string range(const Limits& limits) {
  std::string text;
  const auto add = [&text](const char* words, const std::optional<double>& bound) {
    if (bound) text += (text.empty() ? "" : " and ") + std::string(words) + shown_number(*bound);
  };
  add("above ", limits.above);
  add("at least ", limits.from);
  add("below ", limits.below);
  add("at most ", limits.to);
  return text;
}

bool inside(double x, const Limits& limits) {
  return (!limits.above || x > *limits.above) && (!limits.from || x >= *limits.from) && (!limits.below || x < *limits.below) &&
         (!limits.to || x <= *limits.to);
}

bool check_range(double x, const Place& place, const Limits& limits) {
  if (!std::isfinite(x) || std::fabs(x) > largest_number) {
    place.problem("is " + shown(place.value) + ", larger than any quantity of a scene (" + shown_number(largest_number) +
                  " in SI units); correct it");
    return false;
  }
  if (!inside(x, limits)) {
    place.problem("must be " + range(limits) + (limits.unit.empty() ? "" : " " + limits.unit) + ", found " + shown_number(x));
    return false;
  }
  return true;
}

Json bounded(const char* type, const Limits& limits) {
  Json schema{{"type", type}};
  if (limits.above) schema["exclusiveMinimum"] = *limits.above;
  if (limits.from) schema["minimum"] = *limits.from;
  if (limits.below) schema["exclusiveMaximum"] = *limits.below;
  if (limits.to) schema["maximum"] = *limits.to;
  return schema;
}

}  // namespace

void Codec<double>::read(double& out, const Place& place, const Limits& limits) {
  if (!place.value.is_number()) {
    place.problem("expected a number" + (limits.unit.empty() ? "" : " (" + limits.unit + ")") + ", found " + shown(place.value));
    return;
  }
  const double value = place.value.get<double>();
  if (check_range(value, place, limits)) out = value;
}

Json Codec<double>::schema(const Limits& limits, Schema&) { return bounded("number", limits); }

void Codec<bool>::read(bool& out, const Place& place, const Limits&) {
  if (place.value.is_boolean()) out = place.value.get<bool>();
  else place.problem("expected true or false, found " + shown(place.value));
}

void Codec<std::string>::read(std::string& out, const Place& place, const Limits& limits) {
  if (!limits.choices.empty()) {
    const int index = read_choice(place, limits.choices);
    if (index >= 0) out = limits.choices[static_cast<std::size_t>(index)];
  } else if (!place.value.is_string()) {
    place.problem("expected a string, found " + shown(place.value));
  } else if (place.value.get_ref<const std::string&>().size() < limits.fewest) {
    place.problem("must not be empty");
  } else {
    out = place.value.get<std::string>();
  }
}

Json Codec<std::string>::schema(const Limits& limits, Schema&) {
  if (!limits.choices.empty()) return {{"enum", limits.choices}};
  Json schema{{"type", "string"}};
  if (limits.fewest > 0) schema["minLength"] = limits.fewest;
  return schema;
}

bool read_integer(const Place& place, const Limits& limits, double lowest, double highest, Json& out) {
  const double value = place.value.is_number() ? place.value.get<double>() : 0.5;
  if (!place.value.is_number() || value != std::floor(value)) {
    place.problem("expected a whole number, found " + shown(place.value));
    return false;
  }
  if (!check_range(value, place, limits)) return false;
  if (value < lowest || value > highest) {
    place.problem("must lie from " + shown_number(lowest) + " to " + shown_number(highest) + ", found " + shown(place.value));
    return false;
  }
  out = place.value;
  return true;
}

Json integer_schema(const Limits& limits) { return bounded("integer", limits); }

int read_choice(const Place& place, const std::vector<std::string>& choices) {
  if (place.value.is_string()) {
    const auto found = std::find(choices.begin(), choices.end(), place.value.get<std::string>());
    if (found != choices.end()) return static_cast<int>(found - choices.begin());
  }
  const std::string near = place.value.is_string() ? suggestion(place.value.get<std::string>(), choices) : std::string();
  place.problem("is " + shown(place.value) + near + "; choose one of: " + listed(choices));
  return -1;
}

namespace {
std::string length_words(const Limits& limits) {
  const auto items = [](std::size_t n) { return std::to_string(n) + (n == 1 ? " item" : " items"); };
  if (limits.fewest == limits.most) return items(limits.fewest);
  return limits.most == SIZE_MAX ? "at least " + items(limits.fewest) : std::to_string(limits.fewest) + " to " + items(limits.most);
}
}  // namespace

bool check_list(const Place& place, const Limits& limits) {
  if (!place.value.is_array()) {
    place.problem("expected a list, found " + shown(place.value));
    return false;
  }
  const std::size_t size = place.value.size();
  if (size < limits.fewest || size > limits.most) {
    place.problem("must have " + length_words(limits) + ", found " + std::to_string(size));
    return false;
  }
  const int dimension = place.reader.dimension();
  if (limits.length != Limits::Length::any && dimension != 0) {
    const bool plan = limits.length == Limits::Length::plan;
    const std::size_t expected = static_cast<std::size_t>(plan ? dimension - 1 : dimension);
    if (size != expected) {
      place.problem("must have " + std::to_string(expected) + (expected == 1 ? " number" : " numbers") + ", one for each " +
                    (plan ? "horizontal axis" : "axis") + " of the " + std::to_string(dimension) + "D domain, found " +
                    std::to_string(size));
      return false;
    }
  }
  for (std::size_t i = 0; limits.distinct && i < size; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (place.value[i] == place.value[j]) {
        place.item(i).problem(shown(place.value[i]) + " is in the list already; remove one");
        return false;
      }
  return true;
}

Json list_schema(const Limits& limits, Json items) {
  std::size_t fewest = limits.fewest, most = limits.most;
  if (limits.length == Limits::Length::dimension) fewest = 2, most = 3;
  if (limits.length == Limits::Length::plan) fewest = 1, most = 2;
  Json schema{{"type", "array"}, {"items", std::move(items)}};
  if (fewest > 0) schema["minItems"] = fewest;
  if (most != SIZE_MAX) schema["maxItems"] = most;
  if (limits.distinct) schema["uniqueItems"] = true;
  return schema;
}

namespace {
/// Names become group names of HDF5 files and parts of file names.
const char* const name_pattern = "^[A-Za-z_][A-Za-z0-9_.-]*$";
bool is_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto rest = [&letter](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), rest);
}
}  // namespace

bool check_name(const std::string& name, const Place& place) {
  if (is_name(name)) return true;
  place.problem("\"" + name + "\" is no name: start with a letter, go on with letters, digits, _ . or -");
  return false;
}

bool check_names(const Place& place, const Limits& limits) {
  if (!check_object(place)) return false;
  if (place.value.size() < limits.fewest) place.problem("must have at least " + std::to_string(limits.fewest) + " entry");
  if (!limits.choices.empty()) check_keys(place, limits.choices);
  else
    for (const auto& [name, value] : place.value.items()) check_name(name, place.key(name));
  return true;
}

Json map_schema(const Limits& limits, Json values) {
  Json schema{{"type", "object"}};
  if (limits.fewest > 0) schema["minProperties"] = limits.fewest;
  if (limits.choices.empty()) schema["propertyNames"] = {{"pattern", name_pattern}};
  else schema["propertyNames"] = {{"enum", limits.choices}};
  schema["additionalProperties"] = std::move(values);
  return schema;
}

bool check_object(const Place& place) {
  if (place.value.is_object()) return true;
  place.problem("expected an object, found " + shown(place.value));
  return false;
}

void check_keys(const Place& place, const std::vector<std::string>& names) {
  for (const auto& [name, value] : place.value.items())
    if (std::find(names.begin(), names.end(), name) == names.end())
      place.problem(
          name, "unknown key" + suggestion(name, names) + (names.empty() ? "; no key is known here" : "; valid keys: " + listed(names)));
}

int read_only_key(const Place& place, const std::vector<std::string>& words) {
  if (!check_object(place)) return -1;
  if (place.value.size() != 1) {
    place.problem("must have exactly one key, of: " + listed(words));
    return -1;
  }
  const std::string name = place.value.begin().key();
  const auto found = std::find(words.begin(), words.end(), name);
  if (found != words.end()) return static_cast<int>(found - words.begin());
  check_keys(place, words);
  return -1;
}

Json only_key_schema(const std::string& name, Json value, const std::string& text) {
  Json schema{{"type", "object"}};
  if (!text.empty()) schema["description"] = text;
  schema["properties"] = {{name, std::move(value)}};
  schema["required"] = Json::array({name});
  schema["additionalProperties"] = false;
  return schema;
}

}  // namespace jaxmpm::described
