#pragma once
// A closed planar outline in the first two lattice coordinates: the polygon of a 2D scene, or the footprint of a layer.
#include <vector>

#include "scene/geometry.hpp"

namespace jaxmpm {

class Outline {
 public:
  /// Corners in order around the outline; the last is joined to the first (a repeated first corner at the end is dropped).
  explicit Outline(std::vector<Point> corners);

  /// Intervals of the second coordinate that lie inside at a given first one (even–odd rule).
  void spans(double first, Spans& out) const;
  bool contains(const Point& place) const;
  /// Exact distance in the plane; the third coordinate is ignored.
  SignedDistance signed_distance(const Point& place) const;
  Bounds bounds() const { return bounds_; }
  /// Enclosed area, cells².
  double area() const;

 private:
  Point edge_normal(std::size_t edge) const;

  std::vector<Point> corners_;
  Bounds bounds_;
  double turn_;  // +1 where the corners run anticlockwise
};

/// Outline from deck points; DeckError at `pointer` with fewer than three corners or no area.
Outline make_outline(const std::vector<Point>& corners, const std::string& pointer);

}  // namespace jaxmpm
