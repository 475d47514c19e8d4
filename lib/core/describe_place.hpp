#pragma once
// Where in a JSON document a value stands, and the list of everything that is wrong with it.
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace jaxmpm::described {

using Json = nlohmann::ordered_json;

/// Collects problems; knows the line of a pointer and the dimension of the domain (0 when that itself is broken).
class Reader {
 public:
  Reader(std::function<int(const std::string& pointer)> line_of, int dimension) : line_of_(std::move(line_of)), dimension_(dimension) {}
  void problem(const std::string& pointer, const std::string& message);
  /// Whether something was reported at this pointer or below it.
  bool troubled(const std::string& pointer) const;
  int dimension() const { return dimension_; }
  std::vector<Problem>& problems() { return problems_; }

 private:
  std::function<int(const std::string&)> line_of_;
  int dimension_;
  std::vector<Problem> problems_;
};

/// A value, its JSON pointer, and where to report.
struct Place {
  const Json& value;
  std::string pointer;
  Reader& reader;

  bool given(const std::string& name) const { return value.is_object() && value.contains(name); }
  /// Whether nothing was reported at or below these keys.
  bool sound(const std::vector<std::string>& names) const;
  Place key(const std::string& name) const;
  Place item(std::size_t index) const;
  void problem(const std::string& message) const { reader.problem(pointer, message); }
  /// A problem with a key of this object, present or not.
  void problem(const std::string& name, const std::string& message) const;
};

/// pointer + "/" + name, with ~ and / escaped (RFC 6901).
std::string join(const std::string& pointer, const std::string& name);
/// A value as an error message shows it: its kind, and itself where it is short.
std::string shown(const Json& value);
/// "a, b, c".
std::string listed(const std::vector<std::string>& words);
/// "; did you mean \"cell_size\"?" for the nearest of `words`, or nothing where none is near (Levenshtein distance).
std::string suggestion(const std::string& given, const std::vector<std::string>& words);
/// A number as a message shows it: the fewest digits that read back the same, without a ".0" at the end.
std::string shown_number(double value);

}  // namespace jaxmpm::described
