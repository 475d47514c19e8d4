#include "scene/holding_normals.hpp"

#include <algorithm>
#include <cmath>

#include "scene/geometry.hpp"

namespace jaxmpm {
namespace {

// Lengths in cells.
constexpr double reach = 2;           // material feels nodes so far behind a surface at most
constexpr double thin = 1.5;          // a solid through which the stencils of quadratic splines see
constexpr double tie = 0.1;           // surfaces that are as near as the nearest
constexpr double flat = 0.02;         // how well distances around a node have to be those of a plane
constexpr double outside = 1e-6;      // signed distances above are outside
constexpr double shortest = 0.1;      // step along a line through the solid where the distance tells nothing
constexpr double off_surface = 0.01;  // where a surface's normal is read
constexpr double parallel = 0.966;    // cosine of 15°: normals of one surface

/// A place where a line from the node leaves the solid, with the normal there.
struct Exit {
  Point place, normal;
  double depth;  // of the node behind the surface's plane
  int lines = 1;
};

/// Whether the domain ends at a wall there: at neither a periodic nor an open face.
bool ends_at_wall(const Model& model, int axis, bool upper) { return !model.is_periodic(axis) && !model.is_open(axis, upper); }

/// An obstacle with what lies behind the faces of the domain.
class Solid {
 public:
  Solid(const RigidObstacle& obstacle, const Model& model) : obstacle_(obstacle), model_(model) {}

  SignedDistance at(Point place) const {
    std::array<bool, 3> mirrored{};
    for (int d = 0; d < model_.dim; ++d) {
      double& x = place[std::size_t(d)];
      const double N = model_.cells[std::size_t(d)];
      if (model_.is_periodic(d)) x -= N * std::floor(x / N);
      else if ((x < 0 || x > N) && ends_at_wall(model_, d, x > N)) x = x < 0 ? -x : 2 * N - x, mirrored[std::size_t(d)] = true;
    }
    SignedDistance s = obstacle_.signed_distance(place);
    for (std::size_t d = 0; d < 3; ++d)
      if (mirrored[d]) s.normal[d] = -s.normal[d];
    return s;
  }
  /// Whether one plane is all there is of the surface around the node.
  bool is_flat(const Point& node, const SignedDistance& s) const {
    const double depth = -s.distance;
    return std::abs(at(node + (depth + 1) * s.normal).distance - 1) < flat && std::abs(at(node - s.normal).distance + depth + 1) < flat;
  }
  /// How far it is from a place to where the signed distance passes `outside`, into the solid or out of it; beyond `reach` where it is further.
  double way(const Point& from, const Point& along, bool into) const {
    const auto passed = [&](double t) { return (at(from + t * along).distance > outside) != into; };
    double t = 0;
    while (t <= reach && !passed(t)) t += std::max(shortest, std::abs(at(from + t * along).distance));
    double before = std::max(0.0, t - shortest);
    if (t > reach || before >= t) return t;
    for (int k = 0; k < 30; ++k) {
      const double middle = (before + t) / 2;
      (passed(middle) ? t : before) = middle;
    }
    return t;
  }

 private:
  const RigidObstacle& obstacle_;
  const Model& model_;
};

/// Lines on which a node looks for a way out: all directions between two neighbouring ones of which less than 27° lie.
std::vector<Point> directions(int dim) {
  std::vector<Point> all;
  const int z = dim == 3 ? 2 : 0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -z; k <= z; ++k)
        if (std::abs(i) % 2 + std::abs(j) % 2 + std::abs(k) % 2 > 0) {  // else half of it is there as well
          const Point u{double(i), double(j), double(k)};
          all.push_back(1 / norm(u) * u);
        }
  return all;
}

class Corner {
 public:
  Corner(const Solid& solid, const Point& node, int dim) : solid_(solid), node_(node), dim_(dim) {}

  std::vector<Point> normals() {
    look_around();
    for (const Exit& exit : exits_)
      if (holding_.empty() || exit.depth <= holding_[0].depth + tie || faces_away(exit)) hold(exit);
    for (std::size_t k = 0; k < holding_.size(); ++k) look_along(holding_[k]);
    std::vector<Point> all;
    for (const Exit& exit : holding_) all.push_back(exit.normal);
    pair_up(all);
    return all;
  }

 private:
  /// Finds the surfaces, nearest first, of equally near ones those first that more lines meet.
  void look_around() {
    static const std::array<std::vector<Point>, 2> all{directions(2), directions(3)};
    for (const Point& u : all[dim_ == 3]) {
      const double way = solid_.way(node_, u, false);
      if (way > reach) continue;
      const Point place = node_ + way * u, normal = solid_.at(place + off_surface * u).normal;
      add(exits_, {place, normal, dot(place - node_, normal)});
    }
    std::stable_sort(exits_.begin(), exits_.end(), [](const Exit& a, const Exit& b) {
      const double near_a = std::round(a.depth / tie), near_b = std::round(b.depth / tie);
      return near_a != near_b ? near_a < near_b : a.lines > b.lines;
    });
  }
  /// From a surface that holds along itself: what stands on it holds as well, if the node lies behind that too.
  void look_along(const Exit from) {
    const Point start = from.place + 0.05 * from.normal;
    for (int d = 0; d < 2 * dim_; ++d) {
      Point t = unit_axis(d / 2, d % 2 ? 1.0 : -1.0);
      t = t - dot(t, from.normal) * from.normal;
      if (norm(t) < 0.3) continue;
      t = 1 / norm(t) * t;
      const double way = solid_.way(start, t, true);
      if (way > reach) continue;
      const Point place = start + way * t, normal = solid_.at(place).normal;
      const double depth = dot(place - node_, normal);
      if (depth >= -outside && depth <= reach) hold({place, normal, depth});
    }
  }
  /// Whether a surface is the other side of a thin part of the solid.
  bool faces_away(const Exit& exit) const {
    return exit.depth <= thin &&
           std::any_of(holding_.begin(), holding_.end(), [&](const Exit& h) { return dot(h.normal, exit.normal) < -0.5; });
  }
  /// Puts opposite normals beside each other, in front: a pair takes all motion along it, whatever comes before or after, so that what is
  /// held from all round (a thin post) is held alike from all sides.
  static void pair_up(std::vector<Point>& normals) {
    auto paired = normals.begin();
    for (auto n = normals.begin(); n != normals.end(); ++n) {
      const auto opposite = std::find_if(n + 1, normals.end(), [&](const Point& other) { return dot(*n, other) < -parallel; });
      if (n < paired || opposite == normals.end()) continue;
      std::rotate(paired, n, n + 1);
      std::rotate(paired + 1, opposite, opposite + 1);
      paired += 2, n = paired - 1;
    }
  }
  void hold(const Exit& exit) { add(holding_, exit); }
  /// Of lines that meet the same surface the nearest counts.
  static void add(std::vector<Exit>& exits, const Exit& exit) {
    for (Exit& known : exits)
      if (dot(known.normal, exit.normal) > parallel) {
        const int lines = known.lines + 1;
        if (exit.depth < known.depth) known = exit;
        known.lines = lines;
        return;
      }
    exits.push_back(exit);
  }

  const Solid& solid_;
  const Point& node_;
  int dim_;
  std::vector<Exit> exits_, holding_;
};

/// The normals' parts along the faces of the domain on which the node lies.
std::vector<Point> within_faces(const std::vector<Point>& normals, const Point& node, const Model& model) {
  constexpr double nothing = 1e-6;
  std::vector<Point> kept;
  for (Point n : normals) {
    for (int d = 0; d < model.dim; ++d) {
      const bool low = node[std::size_t(d)] == 0, high = node[std::size_t(d)] == model.cells[std::size_t(d)];
      if ((low || high) && ends_at_wall(model, d, high)) n[std::size_t(d)] = 0;
    }
    if (norm(n) < nothing) continue;
    n = 1 / norm(n) * n;
    if (std::none_of(kept.begin(), kept.end(), [&](const Point& k) { return dot(k, n) > parallel; })) kept.push_back(n);
  }
  return kept.empty() ? std::vector<Point>{Point{}} : kept;
}

}  // namespace

std::vector<Point> holding_normals(const RigidObstacle& obstacle, const Point& node, const Model& model) {
  const Solid solid(obstacle, model);
  const SignedDistance nearest = solid.at(node);
  if (!(nearest.distance <= obstacle_tolerance)) return {};
  std::vector<Point> normals{nearest.normal};
  if (nearest.distance > -reach && !solid.is_flat(node, nearest)) {
    normals = Corner(solid, node, model.dim).normals();
    if (normals.empty()) normals = {nearest.normal};
  }
  return within_faces(normals, node, model);
}

}  // namespace jaxmpm
