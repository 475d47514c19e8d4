#include "scene/triangle_tree.hpp"

#include <algorithm>
#include <numeric>

namespace jaxmpm {
namespace {

constexpr int kLeafSize = 4;

void extend(Bounds& box, const Bounds& by) {
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = std::min(box.lower[d], by.lower[d]);
    box.upper[d] = std::max(box.upper[d], by.upper[d]);
  }
}

double square_distance(const Bounds& box, const Point& place) {
  double square = 0;
  for (int d = 0; d < 3; ++d) {
    const double gap = std::max({box.lower[d] - place[d], 0.0, place[d] - box.upper[d]});
    square += gap * gap;
  }
  return square;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(order_.size()));
}

int TriangleTree::build(int first, int last) {
  const int index = static_cast<int>(nodes_.size());
  Node node;
  node.box = mesh_.bounds_of(order_[first]);
  for (int k = first + 1; k < last; ++k) extend(node.box, mesh_.bounds_of(order_[k]));
  node.first = first;
  node.last = last;
  nodes_.push_back(node);
  if (last - first <= kLeafSize) return index;

  int axis = 0;  // the longest
  for (int d = 1; d < 3; ++d)
    if (node.box.upper[d] - node.box.lower[d] > node.box.upper[axis] - node.box.lower[axis]) axis = d;
  const int middle = (first + last) / 2;
  const auto centre = [&](int t) { return mesh_.corner(t, 0)[axis] + mesh_.corner(t, 1)[axis] + mesh_.corner(t, 2)[axis]; };
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](int s, int t) {
    const double a = centre(s), b = centre(t);
    return a != b ? a < b : s < t;
  });
  const int left = build(first, middle), right = build(middle, last);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

NearestOnMesh TriangleTree::nearest(const Point& place) const {
  NearestOnMesh best;
  best.square = 1e300;
  search(0, place, best);
  return best;
}

void TriangleTree::search(int index, const Point& place, NearestOnMesh& best) const {
  const Node& node = nodes_[index];
  if (node.left < 0) {
    for (int k = node.first; k < node.last; ++k) {
      const NearestOnMesh candidate = mesh_.nearest(order_[k], place);
      if (candidate.square < best.square) best = candidate;
    }
    return;
  }
  const double to_left = square_distance(nodes_[node.left].box, place), to_right = square_distance(nodes_[node.right].box, place);
  const bool left_first = to_left <= to_right;
  if (std::min(to_left, to_right) < best.square) search(left_first ? node.left : node.right, place, best);
  if (std::max(to_left, to_right) < best.square) search(left_first ? node.right : node.left, place, best);
}

}  // namespace jaxmpm
