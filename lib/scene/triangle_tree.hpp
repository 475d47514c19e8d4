#pragma once
// Bounding-volume tree over the triangles of a mesh, for the nearest point of its surface.
#include <vector>

#include "scene/triangle_mesh.hpp"

namespace jaxmpm {

class TriangleTree {
 public:
  /// Keeps a reference to the mesh.
  explicit TriangleTree(const TriangleMesh& mesh);
  NearestOnMesh nearest(const Point& place) const;
  const Bounds& bounds() const { return nodes_[0].box; }

 private:
  /// Inner nodes have their children at `left` and `right`; leaves hold triangles [first, last) of the order.
  struct Node {
    Bounds box;
    int left = -1, right = -1;
    int first = 0, last = 0;
  };
  int build(int first, int last);
  void search(int node, const Point& place, NearestOnMesh& best) const;

  const TriangleMesh& mesh_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace jaxmpm
