#include "fields/ascii_grid.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>

#include "fields/files.hpp"

namespace jaxmpm {
namespace {

std::string lower_case(std::string_view word) {
  std::string text(word);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

class GridReader {
 public:
  GridReader(const std::string& path, const std::string& pointer) : path_(path), pointer_(pointer), contents_(read_file(path, pointer)) {
    std::replace(contents_.begin(), contents_.end(), '\n', ' ');
    rest_ = contents_;
  }

  Raster read() {
    read_header();
    Raster raster;
    raster.columns = count("ncols");
    raster.rows = count("nrows");
    raster.step = required("cellsize");
    if (!(raster.step > 0)) fail("cellsize must be above 0");
    raster.u0 = first_center("xll", raster.step);
    raster.v0 = first_center("yll", raster.step);
    read_values(raster);
    return raster;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { bad_file(pointer_, path_, 0, message); }

  /// Pairs of a name and a number, up to the first word that is a number itself.
  void read_header() {
    double number;
    for (;;) {
      std::string_view look = rest_;
      const std::string_view word = next_word(look);
      if (word.empty() || parse_number(word, number)) return;
      if (!parse_number(next_word(look), number))
        fail("the header entry '" + std::string(word) + "' has no number; this is no ESRI ASCII grid");
      header_[lower_case(word)] = number;
      rest_ = look;
    }
  }

  double required(const std::string& name) const {
    const auto entry = header_.find(name);
    if (entry == header_.end()) fail("the header lacks '" + name + "'; this is no ESRI ASCII grid");
    return entry->second;
  }

  int count(const std::string& name) const {
    const double number = required(name);
    if (!(number >= 1 && number <= 1e6 && number == std::floor(number))) fail(name + " must be a whole number from 1 to 1000000");
    return static_cast<int>(number);
  }

  /// Coordinate of the south-western value: given as its centre, or as the corner of its cell.
  double first_center(const std::string& stem, double step) const {
    if (header_.count(stem + "center") > 0) return required(stem + "center");
    return required(stem + "corner") + 0.5 * step;
  }

  void read_values(Raster& raster) {
    const auto missing = header_.find("nodata_value");
    const std::size_t count = static_cast<std::size_t>(raster.columns) * raster.rows;
    if (count > contents_.size()) fail("the file is too short for " + std::to_string(count) + " values; is it cut off?");
    raster.value.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view word = next_word(rest_);
      double number;
      if (word.empty()) fail("only " + std::to_string(k) + " of " + std::to_string(count) + " values are there; is the file cut off?");
      if (!parse_number(word, number)) fail("'" + std::string(word) + "' (value " + std::to_string(k + 1) + ") is not a number");
      if (missing != header_.end() && number == missing->second) number = std::numeric_limits<double>::quiet_NaN();
      const std::size_t row_from_north = k / raster.columns;
      raster.value[(raster.rows - 1 - row_from_north) * raster.columns + k % raster.columns] = number;
    }
    if (!next_word(rest_).empty()) fail("there are more than the " + std::to_string(count) + " values that the header announces");
  }

  const std::string &path_, &pointer_;
  std::string contents_;
  std::string_view rest_;
  std::map<std::string, double> header_;
};

}  // namespace

Raster read_ascii_grid(const std::string& path, const std::string& pointer) { return GridReader(path, pointer).read(); }

}  // namespace jaxmpm
