// Particles that a file places one by one, instead of a lattice inside a shape.
#include "scene/points.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/error.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

void check_place(const Point& place, const Frame& frame, const Table& table, int line) {
  for (int d = 0; d < frame.dim; ++d)
    if (!(place[d] >= 0 && place[d] <= frame.cells[d]))
      bad_file(table.pointer, table.file, line,
               frame.text(place) + " lies outside the domain; enlarge the domain or leave the particle out");
}

/// Two particles in one place would never part.
void check_apart(const PlacedPoints& placed, const Table& table) {
  std::vector<std::size_t> order(placed.position.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return placed.position[a] != placed.position[b] ? placed.position[a] < placed.position[b] : a < b;
  });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (placed.position[order[k]] == placed.position[order[k - 1]])
      bad_file(table.pointer, table.file, placed.lines[order[k]],
               "a particle in the place of that in line " + std::to_string(placed.lines[order[k - 1]]) + "; leave one out");
}

PlacedPoints read_points(const deck::Points& points, const Frame& frame, const std::string& pointer) {
  const Table table = read_table(frame.file(points.file), pointer + "/file");
  const std::size_t volume = table.column("volume");
  std::array<std::size_t, 3> columns{};
  for (int d = 0; d < frame.dim; ++d) columns[d] = table.column(std::string(1, "xyz"[d]));
  if (frame.dim == 2 && table.has("z")) bad_file(table.pointer, table.file, 0, "the column z has no place in a 2D domain; remove it");
  if (table.rows.empty()) bad_file(table.pointer, table.file, 0, "there is no row, so the body would hold no particle");
  PlacedPoints placed{{}, {}, table.lines, table.file};
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    Point place{};
    for (int d = 0; d < frame.dim; ++d) place[d] = frame.coordinate(table.rows[r][columns[d]], d);
    check_place(place, frame, table, table.lines[r]);
    const double most = std::pow(2 * frame.cell_size, frame.dim);
    if (!(table.rows[r][volume] > 0)) bad_file(table.pointer, table.file, table.lines[r], "a particle's volume must be above 0");
    if (table.rows[r][volume] > most)
      bad_file(table.pointer, table.file, table.lines[r],
               number_text(table.rows[r][volume]) + " is more than a cube of two cells holds, " + number_text(most) +
                   "; correct the unit, or take a larger cell_size");
    placed.position.push_back(place), placed.volume.push_back(table.rows[r][volume]);
  }
  check_apart(placed, table);
  return placed;
}

}  // namespace

PointsGeometry::PointsGeometry(PlacedPoints placed, int dim)
    : placed_(std::move(placed)), bounds_{placed_.position[0], placed_.position[0]} {
  for (const Point& place : placed_.position)
    for (int d = 0; d < dim; ++d)
      bounds_.lower[d] = std::min(bounds_.lower[d], place[d]), bounds_.upper[d] = std::max(bounds_.upper[d], place[d]);
}

SignedDistance PointsGeometry::signed_distance(const Point&) const { throw std::logic_error("points have no surface"); }

GeometryPointer make_points(const deck::Points& shape, const Frame& frame, const std::string& pointer) {
  return std::make_shared<PointsGeometry>(read_points(shape, frame, pointer), frame.dim);
}

}  // namespace jaxmpm
