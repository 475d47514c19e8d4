#include "fields/files.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

constexpr std::string_view kBlanks = " \t\r,;";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = line.find(',');
    parts.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return parts;
    line.remove_prefix(comma + 1);
  }
}

/// Column names, out of their quotes.
std::vector<std::string> header(const std::vector<std::string_view>& words, const std::string& pointer, const std::string& file, int line) {
  std::vector<std::string> names;
  for (std::string_view word : words) {
    if (word.size() >= 2 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
    if (std::find(names.begin(), names.end(), word) != names.end())
      bad_file(pointer, file, line, "two columns are called '" + std::string(word) + "'; remove or rename one");
    names.emplace_back(word);
  }
  if (names.size() == 1 && names[0].find_first_of("; \t") != std::string::npos)
    bad_file(pointer, file, line, "'" + names[0] + "' is one column; separate columns by commas, and write decimals with a point");
  return names;
}

void add_row(Table& table, const std::vector<std::string_view>& words, int line) {
  if (words.size() != table.columns.size())
    bad_file(table.pointer, table.file, line,
             "a row of " + std::to_string(words.size()) + " values under a header of " + std::to_string(table.columns.size()) + " columns");
  std::vector<double> row(words.size());
  for (std::size_t i = 0; i < words.size(); ++i)
    if (!parse_number(words[i], row[i]) || !std::isfinite(row[i]))
      bad_file(table.pointer, table.file, line,
               "'" + std::string(words[i]) + "' in column " + table.columns[i] + " is not a finite number");
  table.rows.push_back(std::move(row));
  table.lines.push_back(line);
}

}  // namespace

void bad_file(const std::string& pointer, const std::string& file, int line, const std::string& message) {
  throw DeckError(pointer, "file '" + file + "'" + (line > 0 ? ", line " + std::to_string(line) : "") + ": " + message);
}

std::string read_file(const std::string& path, const std::string& pointer) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream contents;
  if (!stream || std::filesystem::is_directory(path) || (stream.peek() != EOF && !(contents << stream.rdbuf()))) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "it is not a readable file";
    throw IoError(pointer + ": cannot read the file '" + path + "': " + reason +
                  "; give an existing file, relative names start at the deck");
  }
  return contents.str();
}

std::string_view next_word(std::string_view& text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    text = {};
    return {};
  }
  const std::size_t last = std::min(text.find_first_of(kBlanks, first), text.size());
  const std::string_view word = text.substr(first, last - first);
  text.remove_prefix(last);
  return word;
}

bool parse_number(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const std::from_chars_result result = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && result.ec == std::errc() && result.ptr == word.data() + word.size();
}

bool Table::has(const std::string& name) const {
  return std::any_of(columns.begin(), columns.end(), [&](const std::string& c) { return c == name || c == name + "_m"; });
}

std::size_t Table::column(const std::string& name) const {
  std::string known;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] == name || columns[i] == name + "_m") return i;
    known += (i > 0 ? ", " : "") + columns[i];
  }
  bad_file(pointer, file, 0, "there is no column '" + name + "'; the columns are " + known);
}

Table read_table(const std::string& path, const std::string& pointer) {
  const std::string contents = read_file(path, pointer);
  if (contents.compare(0, 4, "\x89HDF") == 0) bad_file(pointer, path, 0, "this is an HDF5 file; a table is expected, as CSV");
  Table table{path, pointer, {}, {}, {}};
  std::string_view rest = contents;
  if (rest.substr(0, 3) == "\xEF\xBB\xBF") rest.remove_prefix(3);  // a mark that spreadsheets put in front of UTF-8
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    const std::string_view text = trim(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (text.empty() || text.front() == '#') continue;
    const std::vector<std::string_view> words = split(text);
    if (table.columns.empty()) table.columns = header(words, pointer, path, line);
    else add_row(table, words, line);
  }
  if (table.rows.empty()) bad_file(pointer, path, 0, "there are no rows; a table has a header line of column names, then rows of numbers");
  return table;
}

}  // namespace jaxmpm
