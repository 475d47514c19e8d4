#include "scene/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace jaxmpm {
namespace {

using Edge = std::pair<int, int>;

/// Directed edge from corner k to the next.
Edge edge_of(const std::array<int, 3>& t, int k) { return {t[k], t[(k + 1) % 3]}; }

double angle_between(const Point& a, const Point& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

}  // namespace

TriangleMesh::TriangleMesh(const std::vector<Triangle>& triangles, const std::function<void(const std::string&, const Point&)>& fail) {
  weld(triangles);
  check_closed(fail);
  face_outwards(fail);
  make_normals();
}

void TriangleMesh::weld(const std::vector<Triangle>& triangles) {
  std::map<Point, int> index;
  for (const Triangle& t : triangles) {
    std::array<int, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const auto [entry, is_new] = index.emplace(t[k], static_cast<int>(vertices_.size()));
      if (is_new) vertices_.push_back(t[k]);
      corners[k] = entry->second;
    }
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) triangles_.push_back(corners);
  }
}

void TriangleMesh::check_closed(const std::function<void(const std::string&, const Point&)>& fail) const {
  if (triangles_.empty()) fail("all triangles are smaller than a millionth of a cell", {});
  std::map<Edge, int> passes;
  for (const auto& t : triangles_)
    for (int k = 0; k < 3; ++k) ++passes[edge_of(t, k)];
  for (const auto& [edge, count] : passes) {
    const auto back = passes.find({edge.second, edge.first});
    if (back != passes.end() && back->second == count) continue;
    const Point middle = 0.5 * (vertices_[edge.first] + vertices_[edge.second]);
    if (back == passes.end() && count == 1) fail("the surface is not closed: an edge belongs to one triangle only", middle);
    fail("neighbouring triangles face opposite ways, or several sheets meet at an edge", middle);
  }
}

void TriangleMesh::face_outwards(const std::function<void(const std::string&, const Point&)>& fail) {
  double six_volumes = 0;
  for (std::size_t t = 0; t < size(); ++t) six_volumes += dot(corner(t, 0), cross(corner(t, 1), corner(t, 2)));
  if (six_volumes == 0) fail("the surface encloses no volume", vertices_[0]);
  if (six_volumes > 0) return;
  for (auto& t : triangles_) std::swap(t[1], t[2]);
}

void TriangleMesh::make_normals() {
  std::map<Edge, Point> edge_sum;
  vertex_normal_.assign(vertices_.size(), Point{});
  for (std::size_t t = 0; t < size(); ++t) {
    const Point area = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    const double length = norm(area);
    face_normal_.push_back(length > 0 ? (1 / length) * area : Point{});
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = edge_of(triangles_[t], k);
      Point& sum = edge_sum[{std::min(a, b), std::max(a, b)}];
      sum = sum + face_normal_[t];
      const double angle = angle_between(corner(t, (k + 1) % 3) - corner(t, k), corner(t, (k + 2) % 3) - corner(t, k));
      vertex_normal_[a] = vertex_normal_[a] + angle * face_normal_[t];
    }
  }
  edge_normal_.resize(size());
  for (std::size_t t = 0; t < size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = edge_of(triangles_[t], k);
      edge_normal_[t][k] = edge_sum[{std::min(a, b), std::max(a, b)}];
    }
}

Bounds TriangleMesh::bounds_of(std::size_t triangle) const {
  Bounds box{corner(triangle, 0), corner(triangle, 0)};
  for (int k = 1; k < 3; ++k)
    for (int d = 0; d < 3; ++d) {
      box.lower[d] = std::min(box.lower[d], corner(triangle, k)[d]);
      box.upper[d] = std::max(box.upper[d], corner(triangle, k)[d]);
    }
  return box;
}

NearestOnMesh TriangleMesh::nearest(std::size_t triangle, const Point& place) const {
  // Above the triangle (on the inner side of all three edges): the foot of the perpendicular.
  const Point& n = face_normal_[triangle];
  bool above = dot(n, n) > 0;
  for (int k = 0; k < 3; ++k)
    above = above && dot(cross(n, corner(triangle, (k + 1) % 3) - corner(triangle, k)), place - corner(triangle, k)) > 0;
  if (above) {
    const double height = dot(n, place - corner(triangle, 0));
    return {height * height, place - height * n, n};
  }
  NearestOnMesh best;
  best.square = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Point &a = corner(triangle, k), &b = corner(triangle, (k + 1) % 3);
    const Point edge = b - a;
    const double t = std::clamp(dot(place - a, edge) / dot(edge, edge), 0.0, 1.0);
    const Point foot = t == 0 ? a : t == 1 ? b : a + t * edge;
    const double square = dot(place - foot, place - foot);
    if (square >= best.square) continue;
    const Point& normal = t == 0   ? vertex_normal_[triangles_[triangle][k]]
                          : t == 1 ? vertex_normal_[triangles_[triangle][(k + 1) % 3]]
                                   : edge_normal_[triangle][k];
    best = {square, foot, normal};
  }
  return best;
}

}  // namespace jaxmpm
