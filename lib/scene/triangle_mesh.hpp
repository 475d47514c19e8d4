#pragma once
// A closed surface of triangles: corners shared, edges paired, and the normals that tell inside from outside.
#include <array>
#include <functional>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/stl.hpp"

namespace jaxmpm {

/// Nearest point of the surface and its pseudonormal there (not of unit length).
struct NearestOnMesh {
  double square = 0;  // of the distance
  Point place{};
  Point normal{};
};

class TriangleMesh {
 public:
  /// Welds corners that coincide, drops triangles without area, and turns all triangles if they face inwards. `fail` is called with a
  /// message (and does not return) unless every edge is passed once in each direction.
  TriangleMesh(const std::vector<Triangle>& triangles, const std::function<void(const std::string&, const Point&)>& fail);

  std::size_t size() const { return triangles_.size(); }
  const Point& corner(std::size_t triangle, int k) const { return vertices_[triangles_[triangle][k]]; }
  Bounds bounds_of(std::size_t triangle) const;

  /// Nearest point of one triangle. On an edge the normal is the sum of both faces', on a corner the sum weighted with the angles there:
  /// then the sign of (place − nearest)·normal tells outside from inside (Bærentzen & Aanæs 2005).
  NearestOnMesh nearest(std::size_t triangle, const Point& place) const;

 private:
  void weld(const std::vector<Triangle>& triangles);
  void check_closed(const std::function<void(const std::string&, const Point&)>& fail) const;
  void face_outwards(const std::function<void(const std::string&, const Point&)>& fail);
  void make_normals();

  std::vector<Point> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<Point> face_normal_;                 // unit
  std::vector<std::array<Point, 3>> edge_normal_;  // of the edge from corner k to k + 1
  std::vector<Point> vertex_normal_;
};

}  // namespace jaxmpm
