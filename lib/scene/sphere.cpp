// A sphere, in 2D a disc.
#include <cmath>

#include "scene/geometry.hpp"

namespace jaxmpm {
namespace {

class SphereGeometry : public Geometry {
 public:
  SphereGeometry(int dim, const Point& center, double radius) : dim_(dim), center_(center), radius_(radius) {}

  void spans(const Point& place, Spans& out) const override {
    out.clear();
    double half_square = radius_ * radius_;  // of the chord
    for (int d = 0; d < dim_ - 1; ++d) half_square -= (place[d] - center_[d]) * (place[d] - center_[d]);
    if (half_square <= 0) return;
    const double half = std::sqrt(half_square);
    out.push_back({center_[dim_ - 1] - half, center_[dim_ - 1] + half});
  }

  Bounds bounds() const override {
    Bounds box{center_, center_};
    for (int d = 0; d < dim_; ++d) {
      box.lower[d] -= radius_;
      box.upper[d] += radius_;
    }
    return box;
  }

  SignedDistance signed_distance(const Point& place) const override {
    const Point arm = place - center_;
    const double length = norm(arm);
    // The centre has no nearest point of its own: any direction out is right, upwards is taken.
    const Point normal = length > 0 ? (1.0 / length) * arm : unit_axis(dim_ - 1, 1.0);
    return {length - radius_, normal};
  }

 private:
  int dim_;
  Point center_;
  double radius_;
};

}  // namespace

GeometryPointer make_sphere(const deck::Sphere& shape, const Frame& frame, const std::string& pointer) {
  return std::make_shared<SphereGeometry>(frame.dim, frame.place(shape.center, pointer + "/center"), frame.length(shape.radius));
}

}  // namespace jaxmpm
