#pragma once
// Solid below a height map's surface.
#include "scene/geometry.hpp"
#include "scene/height_map_file.hpp"

namespace jaxmpm {

/// The distance is the vertical gap times the upward component of the surface's normal: exact for a plane, elsewhere off by the gap's
/// square times the curvature. The ground reaches down to the domain's bottom.
class GroundGeometry : public Geometry {
 public:
  GroundGeometry(SurfacePointer surface, const Frame& frame);
  void spans(const Point& place, Spans& out) const override;
  Bounds bounds() const override { return bounds_; }
  SignedDistance signed_distance(const Point& place) const override;
  bool may_reach(const Point& lower, const Point& upper, double reach) const override;

 private:
  SurfacePointer surface_;
  int up_;
  Bounds bounds_{};
};

}  // namespace jaxmpm
