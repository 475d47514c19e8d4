#include "scene/frame.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

constexpr double kLatticeSteps = 1048576.0;  // 2²⁰ to a cell

double snap(double cells) { return std::round(cells * kLatticeSteps) / kLatticeSteps; }

}  // namespace

double Frame::coordinate(double metres, int axis) const { return snap((metres - domain_min[axis]) / cell_size); }

double Frame::length(double metres) const { return snap(metres / cell_size); }

Point Frame::place(const deck::Numbers& metres, const std::string& pointer) const {
  if (static_cast<int>(metres.size()) != dim)
    throw DeckError(pointer, "a place has " + std::to_string(dim) + " coordinates here (the length of domain.min), not " +
                                 std::to_string(metres.size()));
  Point place{};
  for (int d = 0; d < dim; ++d) place[d] = coordinate(metres[d], d);
  return place;
}

Point Frame::metres(const Point& place) const {
  Point metres{};
  for (int d = 0; d < dim; ++d) metres[d] = domain_min[d] + place[d] * cell_size;
  return metres;
}

std::string Frame::text(const Point& place) const {
  const Point x = metres(place);
  std::string text = "(";
  for (int d = 0; d < dim; ++d) text += (d > 0 ? ", " : "") + number_text(x[d]);
  return text + ") m";
}

std::string Frame::file(const std::string& name) const {
  const std::filesystem::path path(name);
  return path.is_absolute() ? name : (std::filesystem::path(folder) / path).string();
}

Frame make_frame(const deck::Deck& deck) {
  Frame frame;
  frame.dim = deck.dimension();
  frame.cell_size = deck.domain.cell_size;
  frame.folder = std::filesystem::path(deck.path).parent_path().string();
  for (int d = 0; d < frame.dim; ++d) {
    frame.domain_min[d] = deck.domain.min[d];
    frame.cells[d] = static_cast<int>(std::lround((deck.domain.max[d] - deck.domain.min[d]) / deck.domain.cell_size));
  }
  return frame;
}

std::string number_text(double value) {
  std::ostringstream stream;
  stream.precision(9);
  stream << value;
  return stream.str();
}

}  // namespace jaxmpm
