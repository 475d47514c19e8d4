#include "core/describe_place.hpp"

#include <algorithm>
#include <numeric>

namespace jaxmpm::described {

void Reader::problem(const std::string& pointer, const std::string& message) { problems_.push_back({pointer, line_of_(pointer), message}); }

bool Reader::troubled(const std::string& pointer) const {
  return std::any_of(problems_.begin(), problems_.end(), [&pointer](const Problem& p) {
    return p.pointer.compare(0, pointer.size(), pointer) == 0 && (p.pointer.size() == pointer.size() || p.pointer[pointer.size()] == '/');
  });
}

bool Place::sound(const std::vector<std::string>& names) const {
  return std::none_of(names.begin(), names.end(), [this](const std::string& name) { return reader.troubled(join(pointer, name)); });
}
Place Place::key(const std::string& name) const { return {value.at(name), join(pointer, name), reader}; }
Place Place::item(std::size_t index) const { return {value.at(index), join(pointer, std::to_string(index)), reader}; }
void Place::problem(const std::string& name, const std::string& message) const { reader.problem(join(pointer, name), message); }

std::string join(const std::string& pointer, const std::string& name) {
  std::string escaped;
  for (const char c : name) escaped += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return pointer + "/" + escaped;
}

std::string shown(const Json& value) {
  constexpr std::size_t longest = 60;
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string kind = value.is_object()    ? "an object"
                           : value.is_array()   ? "a list"
                           : value.is_string()  ? "the string"
                           : value.is_number()  ? "the number"
                           : value.is_boolean() ? "the truth value"
                                                : "";
  return text.size() > longest ? kind : kind + (kind.empty() ? "" : " ") + text;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

namespace {
/// Levenshtein distance: fewest insertions, deletions and substitutions that turn one word into the other.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}
}  // namespace

std::string suggestion(const std::string& given, const std::vector<std::string>& words) {
  const auto nearest = std::min_element(words.begin(), words.end(),
                                        [&given](const auto& a, const auto& b) { return distance(given, a) < distance(given, b); });
  if (nearest == words.end() || distance(given, *nearest) > std::max<std::size_t>(2, nearest->size() / 2)) return {};
  return "; did you mean \"" + *nearest + "\"?";
}

std::string shown_number(double value) {
  std::string text = Json(value).dump();
  if (text.size() > 2 && text.compare(text.size() - 2, 2, ".0") == 0) text.erase(text.size() - 2);
  return text;
}

}  // namespace jaxmpm::described
