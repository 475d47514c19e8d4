// Particles that a file places one by one, instead of a lattice inside a shape.
#include "scene/points.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

/// For bodies that lie on a lattice, a cloud of points holds nothing: they are asked whether they hold it.
class PointsGeometry : public Geometry {
 public:
  explicit PointsGeometry(const Bounds& bounds) : bounds_(bounds) {}
  void spans(const Point&, Spans& out) const override { out.clear(); }
  Bounds bounds() const override { return bounds_; }
  SignedDistance signed_distance(const Point&) const override { throw std::logic_error("points have no surface"); }

 private:
  Bounds bounds_;
};

void check_place(const Point& place, const Frame& frame, const Table& table, int line) {
  for (int d = 0; d < frame.dim; ++d)
    if (!(place[d] >= 0 && place[d] <= frame.cells[d]))
      bad_file(table.pointer, table.file, line,
               frame.text(place) + " lies outside the domain; enlarge the domain or leave the particle out");
}

}  // namespace

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
    if (!(table.rows[r][volume] > 0)) bad_file(table.pointer, table.file, table.lines[r], "a particle's volume must be above 0");
    placed.position.push_back(place), placed.volume.push_back(table.rows[r][volume]);
  }
  return placed;
}

GeometryPointer make_points(const deck::Points& shape, const Frame& frame, const std::string& pointer) {
  const PlacedPoints placed = read_points(shape, frame, pointer);
  Bounds bounds{placed.position[0], placed.position[0]};
  for (const Point& place : placed.position)
    for (int d = 0; d < frame.dim; ++d)
      bounds.lower[d] = std::min(bounds.lower[d], place[d]), bounds.upper[d] = std::max(bounds.upper[d], place[d]);
  return std::make_shared<PointsGeometry>(bounds);
}

}  // namespace jaxmpm
