#include "scene/ground.hpp"

#include <cmath>

namespace jaxmpm {

GroundGeometry::GroundGeometry(SurfacePointer surface, const Frame& frame) : surface_(std::move(surface)), up_(frame.up()) {
  for (int d = 0; d < frame.dim; ++d) bounds_.upper[d] = frame.cells[d];
  bounds_.upper[up_] = surface_->ceiling(0, 0, bounds_.upper[0], bounds_.upper[1], 0);
}

void GroundGeometry::spans(const Point& place, Spans& out) const {
  out.clear();
  const double height = surface_->sample(place[0], place[1]).height;
  if (height > 0) out.push_back({0, height});
}

SignedDistance GroundGeometry::signed_distance(const Point& place) const {
  const SurfaceSample s = surface_->sample(place[0], place[1]);
  const double second = up_ == 2 ? s.slope[1] : 0.0;
  const double upward = 1 / std::sqrt(1 + s.slope[0] * s.slope[0] + second * second);
  Point normal{-s.slope[0] * upward, -second * upward, 0};
  normal[up_] = upward;
  return {(place[up_] - s.height) * upward, normal};
}

bool GroundGeometry::may_reach(const Point& lower, const Point& upper, double reach) const {
  return lower[up_] < surface_->ceiling(lower[0], lower[1], upper[0], upper[1], reach);
}

GeometryPointer make_height_map(const deck::HeightMap& shape, const Frame& frame, const std::string& pointer) {
  return std::make_shared<GroundGeometry>(load_surface(shape, frame, pointer), frame);
}

}  // namespace jaxmpm
