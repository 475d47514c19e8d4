// An axis-parallel box.
#include <algorithm>

#include "scene/geometry.hpp"

namespace jaxmpm {
namespace {

class BoxGeometry : public Geometry {
 public:
  BoxGeometry(int dim, const Point& lower, const Point& upper) : dim_(dim), lower_(lower), upper_(upper) {}

  void spans(const Point& place, Spans& out) const override {
    out.clear();
    for (int d = 0; d < dim_ - 1; ++d)
      if (place[d] < lower_[d] || place[d] >= upper_[d]) return;
    if (lower_[dim_ - 1] < upper_[dim_ - 1]) out.push_back({lower_[dim_ - 1], upper_[dim_ - 1]});
  }

  Bounds bounds() const override { return {lower_, upper_}; }

  SignedDistance signed_distance(const Point& place) const override {
    Point nearest = place;
    double deepest = -1e300;  // signed distance to the nearest face plane
    Point face_normal{};
    bool outside = false;
    for (int d = 0; d < dim_; ++d) {
      nearest[d] = std::clamp(place[d], lower_[d], upper_[d]);
      outside = outside || nearest[d] != place[d];
      const double below = lower_[d] - place[d], above = place[d] - upper_[d];
      const double face = std::max(below, above);
      if (face > deepest) {
        deepest = face;
        face_normal = unit_axis(d, above >= below ? 1.0 : -1.0);
      }
    }
    return outside ? from_nearest(place, nearest, false, face_normal) : SignedDistance{deepest, face_normal};
  }

 private:
  int dim_;
  Point lower_, upper_;
};

}  // namespace

GeometryPointer make_box(const deck::Box& shape, const Frame& frame, const std::string& pointer) {
  return std::make_shared<BoxGeometry>(frame.dim, frame.place(shape.min, pointer + "/min"), frame.place(shape.max, pointer + "/max"));
}

}  // namespace jaxmpm
