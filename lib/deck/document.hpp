#pragma once
// JSON text with // comments as a tree that remembers the line of every value, and `--set` assignments to it.
#include <map>
#include <string>
#include <vector>

#include "core/describe_place.hpp"

namespace jaxmpm::deck {

class Document {
 public:
  /// Parses; broken syntax is a DeckError with the line, the pointer of the innermost open value and what was expected.
  /// Duplicate keys do not stop it: they are listed in `problems`, and the first of them counts.
  static Document parse(const std::string& text);

  /// Applies "/pointer=JSON" (a value that is no JSON is a string); creates a missing last key. What is wrong is listed in `problems`.
  void assign(const std::string& assignment);

  const described::Json& root() const { return root_; }
  /// Line of the value at a pointer, or of the nearest one above it; 0 where --set put it.
  int line(const std::string& pointer) const;
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  described::Json root_;
  std::map<std::string, int> lines_;
  std::vector<Problem> problems_;
};

}  // namespace jaxmpm::deck
