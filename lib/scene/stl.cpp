#include "scene/stl.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "fields/files.hpp"

namespace jaxmpm {
namespace {

// Binary layout: 80 bytes of header, a 32-bit count, then 50 bytes a facet: normal, three corners (12 floats) and 2 bytes. Little-endian.
constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12, kCorner = 12;

std::uint32_t facet_count(const std::string& contents) {
  std::uint32_t count = 0;
  if (contents.size() >= kHeader) std::memcpy(&count, contents.data() + 80, sizeof count);
  return count;
}

/// The size decides: text files may begin with any word, and so may the header of binary ones.
bool is_binary(const std::string& contents) {
  return contents.size() >= kHeader && contents.size() == kHeader + kFacet * facet_count(contents);
}

std::vector<Triangle> read_binary(const std::string& contents) {
  std::vector<Triangle> triangles(facet_count(contents));
  const char* facet = contents.data() + kHeader;
  for (Triangle& t : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      float x[3];
      std::memcpy(x, facet + kNormal + corner * kCorner, sizeof x);
      std::copy(x, x + 3, t[corner].begin());
    }
    facet += kFacet;
  }
  return triangles;
}

std::vector<Triangle> read_text(std::string contents, const std::string& path, const std::string& pointer) {
  std::vector<Point> corners;
  std::replace(contents.begin(), contents.end(), '\n', ' ');
  std::string_view rest = contents;
  if (next_word(rest) != "solid") bad_file(pointer, path, 0, "this is neither a text nor a whole binary STL file");
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    if (word != "vertex") continue;
    Point corner{};
    for (double& x : corner) {
      const std::string_view number = next_word(rest);
      if (!parse_number(number, x))
        bad_file(pointer, path, 0, "vertex " + std::to_string(corners.size() + 1) + ": '" + std::string(number) + "' is not a number");
    }
    corners.push_back(corner);
  }
  if (corners.size() % 3 != 0) bad_file(pointer, path, 0, "the number of corners is no multiple of three; is the file cut off?");
  std::vector<Triangle> triangles(corners.size() / 3);
  for (std::size_t k = 0; k < corners.size(); ++k) triangles[k / 3][k % 3] = corners[k];
  return triangles;
}

bool finite(const Triangle& t) {
  return std::all_of(t.begin(), t.end(),
                     [](const Point& p) { return std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x); }); });
}

}  // namespace

std::vector<Triangle> read_stl(const std::string& path, const std::string& pointer) {
  const std::string contents = read_file(path, pointer);
  std::vector<Triangle> triangles = is_binary(contents) ? read_binary(contents) : read_text(contents, path, pointer);
  if (triangles.empty()) bad_file(pointer, path, 0, "there are no triangles");
  if (!std::all_of(triangles.begin(), triangles.end(), finite)) bad_file(pointer, path, 0, "a corner is not finite");
  return triangles;
}

}  // namespace jaxmpm
