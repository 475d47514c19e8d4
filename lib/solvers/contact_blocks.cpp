#include "solvers/contact_blocks.hpp"

#include <algorithm>

#include "core/parallel_host.hpp"
#include "kernels/wall_node.hpp"
#include "scene/holding_normals.hpp"

namespace jaxmpm {
namespace {

template <int Dim>
Point as_point(const Index<Dim>& node) {
  Point p{};
  for (int d = 0; d < Dim; ++d) p[std::size_t(d)] = node[std::size_t(d)];
  return p;
}

}  // namespace

double mass_cut_off(const Model& model) {
  double largest = 0;
  for (const Body& body : model.bodies)
    for (const double m : body.initial.mass) largest = std::max(largest, m);
  return 1e-20 * largest;
}

template <class T, int Dim>
bool ContactBlocks<T, Dim>::at_wall(const Walls<T, Dim>& walls, const Node& block) const {
  constexpr int B = BlockShape<Dim, 2>::B;
  const Node first = first_node<Dim>(block);
  for (int d = 0; d < Dim; ++d)
    if (walls.near_face(d, first[std::size_t(d)]) || walls.near_face(d, first[std::size_t(d)] + B - 1)) return true;
  return false;
}

template <class T, int Dim>
auto ContactBlocks<T, Dim>::obstacle_nodes(const Node& block) const -> std::shared_ptr<const ObstacleNodes> {
  using Shape = BlockShape<Dim, 2>;
  const Node first = first_node<Dim>(block);
  Point lower = as_point<Dim>(first), upper = lower;
  for (int d = 0; d < Dim; ++d) upper[std::size_t(d)] += Shape::B - 1;
  ObstacleNodes found;
  for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
    const RigidObstacle& obstacle = model_.obstacles[o];
    if (!obstacle.may_touch(lower, upper)) continue;
    for (int own = 0; own < Shape::cells; ++own) {
      for (const Point& normal : holding_normals(obstacle, as_point<Dim>(node_of<Dim>(first, own)), model_)) {
        ObstacleNode<T, Dim> node{std::uint32_t(own), std::uint32_t(o), {}};
        for (int c = 0; c < Dim; ++c) node.normal[c] = T(normal[std::size_t(c)]);
        found.push_back(node);
      }
    }
  }
  return found.empty() ? nullptr : std::make_shared<const ObstacleNodes>(std::move(found));
}

template <class T, int Dim>
void ContactBlocks<T, Dim>::rebuild(const Blocks<Dim>& blocks) {
  const std::size_t n = blocks.count();
  const Walls<T, Dim> walls = table_.view();
  wall_slot_.assign(n, -1), wall_blocks_.clear();
  for (std::size_t b = 0; b < n; ++b)
    if (at_wall(walls, blocks.index[b])) wall_slot_[b] = int(wall_blocks_.size()), wall_blocks_.push_back(std::uint32_t(b));
  obstacles_.assign(n, nullptr);
  if (model_.obstacles.empty()) return;
  std::vector<std::uint32_t> unknown;
  const auto key = [](const Node& block) {
    std::int64_t k = 0;
    for (const int i : block) k = (k << 21) + i;
    return k;
  };
  for (std::size_t b = 0; b < n; ++b) {
    const auto known = known_.find(key(blocks.index[b]));
    if (known != known_.end()) obstacles_[b] = known->second;
    else unknown.push_back(std::uint32_t(b));
  }
  parallel_for_host("jaxmpm::obstacles", unknown.size(),
                    [&](std::size_t k) { obstacles_[unknown[k]] = obstacle_nodes(blocks.index[unknown[k]]); });
  for (const std::uint32_t b : unknown) known_.emplace(key(blocks.index[b]), obstacles_[b]);
}

template class ContactBlocks<float, 2>;
template class ContactBlocks<float, 3>;
template class ContactBlocks<double, 2>;
template class ContactBlocks<double, 3>;

}  // namespace jaxmpm
