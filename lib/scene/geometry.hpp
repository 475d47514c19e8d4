#pragma once
// A shape of the deck in lattice coordinates (cells from domain.min). Seeding asks for the solid along columns of the last axis, contact
// for a signed distance. All calls are const and thread-safe.
#include <memory>
#include <string>
#include <vector>

#include "scene/frame.hpp"
#include "scene/model.hpp"
#include "scene/spans.hpp"

namespace jaxmpm {

struct Bounds {
  Point lower, upper;
};

class Geometry {
 public:
  virtual ~Geometry() = default;
  /// Solid along the column through `place` parallel to the last axis (the last coordinate of `place` is not read). Sorted; `out` is
  /// overwritten.
  virtual void spans(const Point& place, Spans& out) const = 0;
  /// Smallest box known to hold the solid, cells.
  virtual Bounds bounds() const = 0;
  /// Whether the solid reaches both faces of that box across an axis; where not, only its columns tell how far it reaches.
  virtual bool exact_bounds(int axis) const;
  /// Distance to the surface in cells, negative inside, with a unit normal out of the solid.
  virtual SignedDistance signed_distance(const Point& place) const = 0;
  /// Whether the box can hold places with a signed distance below `reach` (may err towards true). By default from the distance of the box's
  /// centre, which holds for every distance that changes by at most one cell per cell.
  virtual bool may_reach(const Point& lower, const Point& upper, double reach) const;
};
using GeometryPointer = std::shared_ptr<const Geometry>;

/// Builds a shape of the deck. `pointer` is its JSON pointer, e.g. /bodies/0/shape. Throws DeckError (unusable shape or file contents) or
/// IoError (unreadable file).
GeometryPointer make_geometry(const deck::Shape& shape, const Frame& frame, const std::string& pointer);

// The kinds; each lives in the file of its name.
GeometryPointer make_box(const deck::Box& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_sphere(const deck::Sphere& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_cylinder(const deck::Cylinder& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_polygon(const deck::Polygon& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_mesh(const deck::Mesh& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_height_map(const deck::HeightMap& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_layer(const deck::Layer& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_points(const deck::Points& shape, const Frame& frame, const std::string& pointer);
GeometryPointer make_union(std::vector<GeometryPointer> parts);
GeometryPointer make_difference(GeometryPointer from, GeometryPointer taken);

// Small vector algebra on places.
inline Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double norm(const Point& a);
Point unit_axis(int axis, double sign);

/// Distance to the surface point nearest to `place`: away from the surface the normal points along their connection; on it, it is
/// `surface_normal`.
SignedDistance from_nearest(const Point& place, const Point& nearest, bool inside, const Point& surface_normal);

}  // namespace jaxmpm
