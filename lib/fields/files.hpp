#pragma once
// Reading the data files that a deck names. `pointer` is the JSON pointer of the key that names the file: an unreadable file is an IoError,
// unusable contents are a DeckError, both with that pointer, the file and the line.
#include <string>
#include <string_view>
#include <vector>

namespace jaxmpm {

/// Whole contents of a file.
std::string read_file(const std::string& path, const std::string& pointer);

/// The next word (separated by blanks or commas) of `text`, which is cut behind it; empty at the end.
std::string_view next_word(std::string_view& text);

/// Whether the whole word is a finite or non-finite number in C notation ("1e-3", "nan"); independent of locale.
bool parse_number(std::string_view word, double& value);

/// A table of numbers: # comments, one header line of column names, then rows; separated by commas, blanks around them are ignored.
struct Table {
  std::string file, pointer;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;  // line of each row in the file
  /// Index of a column, by its name or its name with the unit suffix "_m"; DeckError naming the columns there are.
  std::size_t column(const std::string& name) const;
  bool has(const std::string& name) const;
};
/// Throws when a row has another number of values than the header, or a value that is not a finite number.
Table read_table(const std::string& path, const std::string& pointer);

/// Throws the DeckError of unusable contents at a line of a file.
[[noreturn]] void bad_file(const std::string& pointer, const std::string& file, int line, const std::string& message);

}  // namespace jaxmpm
