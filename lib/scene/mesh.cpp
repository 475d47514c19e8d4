// The inside of a closed surface of triangles.
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "scene/triangle_tree.hpp"

namespace jaxmpm {
namespace {

/// Side of the line a → b, in plan, on which a place lies: the sign of (b − a) × (p − a). A place on the line counts as shifted by (ε, ε²),
/// and the line is always taken from its lesser end, so that two triangles that share an edge never both claim a place, nor both leave it
/// out.
int side_of(const Point& a, const Point& b, const Point& p) {
  const bool swapped = std::make_pair(b[0], b[1]) < std::make_pair(a[0], a[1]);
  const Point &from = swapped ? b : a, &to = swapped ? a : b;
  const double ex = to[0] - from[0], ey = to[1] - from[1];
  double value = ex * (p[1] - from[1]) - ey * (p[0] - from[0]);
  if (value == 0) value = ey != 0 ? -ey : ex;
  const int sign = value > 0 ? 1 : value < 0 ? -1 : 0;
  return swapped ? -sign : sign;
}

class MeshGeometry : public Geometry {
 public:
  explicit MeshGeometry(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(mesh_) { fill_bins(); }
  MeshGeometry(const MeshGeometry&) = delete;  // the tree refers to the mesh
  MeshGeometry& operator=(const MeshGeometry&) = delete;

  /// Solid where the crossings of the column wind around the place (non-zero rule).
  void spans(const Point& place, Spans& out) const override {
    out.clear();
    const int bin = bin_of(place);
    if (bin < 0) return;
    std::vector<Crossing> crossings;
    for (const int t : bins_[bin]) cross_column(t, place, crossings);
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.height < b.height; });
    int winding = 0;
    double start = 0;
    for (const Crossing& c : crossings) {
      if (winding == 0) start = c.height;
      winding += c.step;
      if (winding == 0 && start < c.height) out.push_back({start, c.height});
    }
  }

  Bounds bounds() const override { return tree_.bounds(); }

  SignedDistance signed_distance(const Point& place) const override {
    const NearestOnMesh nearest = tree_.nearest(place);
    const bool inside = dot(place - nearest.place, nearest.normal) < 0;
    const double length = norm(nearest.normal);
    const Point normal = length > 0 ? (1 / length) * nearest.normal : unit_axis(2, 1.0);
    return from_nearest(place, nearest.place, inside, normal);
  }

 private:
  struct Crossing {
    double height;
    int step;  // +1 on the way in, −1 on the way out
  };

  void cross_column(int t, const Point& place, std::vector<Crossing>& crossings) const {
    const Point &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
    const Point normal = cross(b - a, c - a);
    if (normal[2] == 0) return;  // upright: its neighbours bound the column
    const int side = side_of(a, b, place);
    if (side_of(b, c, place) != side || side_of(c, a, place) != side) return;
    const double height = a[2] - (normal[0] * (place[0] - a[0]) + normal[1] * (place[1] - a[1])) / normal[2];
    crossings.push_back({height, normal[2] < 0 ? 1 : -1});
  }

  void fill_bins() {
    const Bounds box = tree_.bounds();
    bins_across_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(mesh_.size()))), 1, 1024);
    bins_.resize(static_cast<std::size_t>(bins_across_) * bins_across_);
    for (std::size_t t = 0; t < mesh_.size(); ++t) {
      const Bounds b = mesh_.bounds_of(t);
      for (int j = bin_index(b.lower[1], 1, box); j <= bin_index(b.upper[1], 1, box); ++j)
        for (int i = bin_index(b.lower[0], 0, box); i <= bin_index(b.upper[0], 0, box); ++i)
          bins_[static_cast<std::size_t>(j) * bins_across_ + i].push_back(static_cast<int>(t));
    }
  }

  int bin_index(double coordinate, int axis, const Bounds& box) const {
    const double part = (coordinate - box.lower[axis]) / (box.upper[axis] - box.lower[axis]);
    return std::clamp(static_cast<int>(part * bins_across_), 0, bins_across_ - 1);
  }

  int bin_of(const Point& place) const {
    const Bounds& box = tree_.bounds();
    for (int d = 0; d < 2; ++d)
      if (place[d] < box.lower[d] || place[d] > box.upper[d]) return -1;
    return bin_index(place[1], 1, box) * bins_across_ + bin_index(place[0], 0, box);
  }

  TriangleMesh mesh_;
  TriangleTree tree_;
  int bins_across_ = 1;
  std::vector<std::vector<int>> bins_;  // triangles over each patch of the plan
};

}  // namespace

GeometryPointer make_mesh(const deck::Mesh& shape, const Frame& frame, const std::string& pointer) {
  if (frame.dim != 3) throw DeckError(pointer, "a mesh needs a three-dimensional domain; in 2D use polygon");
  if (!shape.offset.empty() && shape.offset.size() != 3) throw DeckError(pointer + "/offset", "give one number for each of the 3 axes");
  const std::string path = frame.file(shape.file);
  std::vector<Triangle> triangles = read_stl(path, pointer + "/file");
  for (Triangle& t : triangles)
    for (Point& corner : t)
      for (int d = 0; d < 3; ++d) corner[d] = frame.coordinate(shape.scale * corner[d] + (shape.offset.empty() ? 0.0 : shape.offset[d]), d);
  return std::make_shared<MeshGeometry>(TriangleMesh(triangles, [&](const std::string& message, const Point& place) {
    throw DeckError(pointer + "/file",
                    "mesh '" + path + "', near " + frame.text(place) + ": " + message + "; repair it so that it encloses a volume");
  }));
}

}  // namespace jaxmpm
