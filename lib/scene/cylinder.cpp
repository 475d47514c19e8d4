// A circular cylinder between two end centres (3D).
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "scene/geometry.hpp"

namespace jaxmpm {
namespace {

class CylinderGeometry : public Geometry {
 public:
  CylinderGeometry(const Point& from, const Point& to, double radius)
      : from_(from), to_(to), length_(norm(to - from)), axis_((1.0 / norm(to - from)) * (to - from)), radius_(radius) {}

  /// The column is the line z: with arm = place − from, s(z) = arm·axis + z axis_z runs along the axis, and |arm + z e_z|² − s² < R² bounds
  /// z.
  void spans(const Point& place, Spans& out) const override {
    out.clear();
    const Point arm{place[0] - from_[0], place[1] - from_[1], 0};
    const double along = dot(arm, axis_), rise = axis_[2];
    Span slab{-1e300, 1e300};
    if (std::abs(rise) > kParallel)
      slab = {std::min(-along / rise, (length_ - along) / rise), std::max(-along / rise, (length_ - along) / rise)};
    else if (along < 0 || along >= length_) return;

    const double a = 1 - rise * rise, half_b = -along * rise, c = dot(arm, arm) - along * along - radius_ * radius_;
    Span wall{-1e300, 1e300};
    if (a > kParallel) {
      const double discriminant = half_b * half_b - a * c;
      if (discriminant <= 0) return;
      wall = {(-half_b - std::sqrt(discriminant)) / a, (-half_b + std::sqrt(discriminant)) / a};
    } else if (c >= 0) {
      return;
    }
    const Span common{from_[2] + std::max(slab.lower, wall.lower), from_[2] + std::min(slab.upper, wall.upper)};
    if (common.lower < common.upper) out.push_back(common);
  }

  /// Along axis d an end disc reaches R √(1 − axis_d²) from its centre.
  Bounds bounds() const override {
    Bounds box{};
    for (int d = 0; d < 3; ++d) {
      const double reach = radius_ * std::sqrt(std::max(0.0, 1 - axis_[d] * axis_[d]));
      box.lower[d] = std::min(from_[d], to_[d]) - reach;
      box.upper[d] = std::max(from_[d], to_[d]) + reach;
    }
    return box;
  }

  /// In the meridian plane (axial coordinate s, radius r) the cylinder is a rectangle.
  SignedDistance signed_distance(const Point& place) const override {
    const Point arm = place - from_;
    const double s = dot(arm, axis_);
    const Point radial = arm - s * axis_;
    const double r = norm(radial);
    const Point outward = r > 0 ? (1.0 / r) * radial : any_normal();
    const double end = std::max(-s, s - length_), side = r - radius_;
    const Point end_normal = (2 * s < length_ ? -1.0 : 1.0) * axis_;
    const Point normal = end > side ? end_normal : outward;
    if (end <= 0 && side <= 0) return {std::max(end, side), normal};
    const Point nearest = from_ + std::clamp(s, 0.0, length_) * axis_ + std::min(r, radius_) * outward;
    return from_nearest(place, nearest, false, normal);
  }

 private:
  static constexpr double kParallel = 1e-14;

  Point any_normal() const {
    const int least = std::abs(axis_[0]) < 0.6 ? 0 : 1;
    const Point n = cross(axis_, unit_axis(least, 1.0));
    return (1.0 / norm(n)) * n;
  }

  Point from_, to_;
  double length_;
  Point axis_;
  double radius_;
};

}  // namespace

GeometryPointer make_cylinder(const deck::Cylinder& shape, const Frame& frame, const std::string& pointer) {
  if (frame.dim != 3) throw DeckError(pointer, "a cylinder needs a three-dimensional domain; in 2D use sphere (a disc), box or polygon");
  const Point from = frame.place(shape.from, pointer + "/from"), to = frame.place(shape.to, pointer + "/to");
  if (from == to) throw DeckError(pointer, "the two end centres coincide; give the centres of both ends");
  return std::make_shared<CylinderGeometry>(from, to, frame.length(shape.radius));
}

}  // namespace jaxmpm
