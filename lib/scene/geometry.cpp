#include "scene/geometry.hpp"

#include <cmath>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

constexpr double kOnSurface = 1e-9;  // cells; nearer than this the direction to the surface is round-off

struct MakeGeometry {
  const Frame& frame;
  const std::string& pointer;

  GeometryPointer operator()(const deck::Box& s) const { return make_box(s, frame, pointer + "/box"); }
  GeometryPointer operator()(const deck::Sphere& s) const { return make_sphere(s, frame, pointer + "/sphere"); }
  GeometryPointer operator()(const deck::Cylinder& s) const { return make_cylinder(s, frame, pointer + "/cylinder"); }
  GeometryPointer operator()(const deck::Polygon& s) const { return make_polygon(s, frame, pointer + "/polygon"); }
  GeometryPointer operator()(const deck::Mesh& s) const { return make_mesh(s, frame, pointer + "/mesh"); }
  GeometryPointer operator()(const deck::HeightMap& s) const { return make_height_map(s, frame, pointer + "/height_map"); }
  GeometryPointer operator()(const deck::Layer& s) const { return make_layer(s, frame, pointer + "/layer"); }
  GeometryPointer operator()(const deck::Points& s) const { return make_points(s, frame, pointer + "/points"); }
  GeometryPointer operator()(const deck::Union& s) const { return make_union(parts(s.shapes, pointer + "/union")); }
  GeometryPointer operator()(const deck::Difference& s) const {
    const std::string place = pointer + "/difference";
    const std::vector<GeometryPointer> both = parts(s.shapes, place);
    if (both.size() != 2) throw DeckError(place, "difference takes two shapes: what is kept and what is taken from it");
    return make_difference(both[0], both[1]);
  }

  std::vector<GeometryPointer> parts(const std::vector<deck::Shape>& shapes, const std::string& place) const {
    if (shapes.empty()) throw DeckError(place, "give at least one shape");
    std::vector<GeometryPointer> made;
    for (std::size_t i = 0; i < shapes.size(); ++i) made.push_back(make_geometry(shapes[i], frame, place + "/" + std::to_string(i)));
    return made;
  }
};

}  // namespace

GeometryPointer make_geometry(const deck::Shape& shape, const Frame& frame, const std::string& pointer) {
  return std::visit(MakeGeometry{frame, pointer}, shape.kind);
}

bool Geometry::may_reach(const Point& lower, const Point& upper, double reach) const {
  const double half_diagonal = 0.5 * norm(upper - lower);
  return signed_distance(0.5 * (lower + upper)).distance < reach + half_diagonal;
}

bool Geometry::exact_bounds(int) const { return true; }

double norm(const Point& a) { return std::sqrt(dot(a, a)); }

Point unit_axis(int axis, double sign) {
  Point e{};
  e[axis] = sign;
  return e;
}

SignedDistance from_nearest(const Point& place, const Point& nearest, bool inside, const Point& surface_normal) {
  const Point gap = place - nearest;
  const double length = norm(gap);
  const double sign = inside ? -1.0 : 1.0;
  if (length < kOnSurface) return {sign * length, surface_normal};
  return {sign * length, (sign / length) * gap};
}

}  // namespace jaxmpm
