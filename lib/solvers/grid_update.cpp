#include "solvers/grid_update.hpp"

#include "core/parallel.hpp"

namespace jaxmpm {
namespace {

template <int Dim>
Index<Dim> first_node(const Index<Dim>& block) {
  Index<Dim> node;
  for (int d = 0; d < Dim; ++d) node[std::size_t(d)] = BlockShape<Dim, 2>::first_node(block[std::size_t(d)]);
  return node;
}

/// Coordinates of own node `own` of a block that starts at `first`.
template <int Dim>
Index<Dim> node_of(const Index<Dim>& first, int own) {
  constexpr int B = BlockShape<Dim, 2>::B;
  Index<Dim> node = first;
  for (int d = Dim - 1; d >= 0; --d, own /= B) node[std::size_t(d)] += own % B;
  return node;
}

template <int Dim>
Point as_point(const Index<Dim>& node) {
  Point p{};
  for (int d = 0; d < Dim; ++d) p[std::size_t(d)] = node[std::size_t(d)];
  return p;
}

/// Largest particle mass of a model: what small nodal masses are measured against.
double largest_mass(const Model& model) {
  double largest = 0;
  for (const Body& body : model.bodies)
    for (const double m : body.initial.mass) largest = std::max(largest, m);
  return largest;
}

/// A node near a block: which active block holds it and where.
template <int Dim>
struct Place {
  int block, own;
};

template <int Dim>
Place<Dim> locate(const Blocks<Dim>& blocks, std::size_t b, const Index<Dim>& first, const Index<Dim>& node) {
  constexpr int B = BlockShape<Dim, 2>::B;
  int neighbour = 0, own = 0;
  for (int d = 0; d < Dim; ++d) {
    const int local = node[std::size_t(d)] - first[std::size_t(d)], step = local < 0 ? 0 : (local >= B ? 2 : 1);
    neighbour = neighbour * 3 + step, own = own * B + local - (step - 1) * B;
  }
  return {blocks.neighbour[b * BlockShape<Dim, 2>::neighbours + std::size_t(neighbour)], own};
}

template <class T, int Dim>
void add(Point& to, const T& impulse) {
  for (int c = 0; c < Dim; ++c) to[std::size_t(c)] += double(impulse[std::size_t(c)]);
}

}  // namespace

template <class T, int Dim>
GridUpdate<T, Dim>::GridUpdate(const Model& model, const StepKernels<T, Dim>& kernels)
    : model_(model), kernels_(kernels), walls_(model), mass_cut_off_(T(1e-20 * largest_mass(model))) {}

template <class T, int Dim>
bool GridUpdate<T, Dim>::at_wall(const Node& block) const {
  const Node first = first_node<Dim>(block);
  for (int d = 0; d < Dim; ++d)
    if (walls_.near_face(d, first[std::size_t(d)]) || walls_.near_face(d, first[std::size_t(d)] + B - 1)) return true;
  return false;
}

template <class T, int Dim>
auto GridUpdate<T, Dim>::obstacle_nodes(const Node& block) -> std::shared_ptr<const ObstacleNodes> {
  const Node first = first_node<Dim>(block);
  Point lower = as_point<Dim>(first), upper = lower;
  for (int d = 0; d < Dim; ++d) upper[std::size_t(d)] += B - 1;
  ObstacleNodes found;
  for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
    const RigidObstacle& obstacle = model_.obstacles[o];
    if (!obstacle.may_touch(lower, upper)) continue;
    for (int own = 0; own < cells; ++own) {
      const SignedDistance s = obstacle.signed_distance(as_point<Dim>(node_of<Dim>(first, own)));
      if (!(s.distance <= obstacle_tolerance)) continue;
      ObstacleNode<T, Dim> node{std::uint32_t(own), std::uint32_t(o), {}};
      for (int c = 0; c < Dim; ++c) node.normal[c] = T(s.normal[std::size_t(c)]);
      found.push_back(node);
    }
  }
  return found.empty() ? nullptr : std::make_shared<const ObstacleNodes>(std::move(found));
}

template <class T, int Dim>
void GridUpdate<T, Dim>::rebuild(const Blocks<Dim>& blocks) {
  const std::size_t n = blocks.count();
  wall_slot_.assign(n, -1), wall_blocks_.clear();
  for (std::size_t b = 0; b < n; ++b)
    if (at_wall(blocks.index[b])) wall_slot_[b] = int(wall_blocks_.size()), wall_blocks_.push_back(std::uint32_t(b));
  grid_.resize(n * kernels_.own_size), raw_.resize(wall_blocks_.size() * kernels_.own_size);
  contact_.resize(n);
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

template <class T, int Dim>
void GridUpdate<T, Dim>::update(const Blocks<Dim>& blocks, const T* arenas, double dt) {
  GridConstants<T, Dim> constants{{}, mass_cut_off_};
  for (int c = 0; c < Dim; ++c) constants.gravity_step[c] = T(dt * model_.gravity[std::size_t(c)]);
  parallel_for_host("jaxmpm::grid", blocks.count(), [&](std::size_t b) { update_block(blocks, b, arenas, constants); });
  parallel_for_host("jaxmpm::walls", wall_blocks_.size(), [&](std::size_t w) { update_wall_block(blocks, wall_blocks_[w], constants); });
}

template <class T, int Dim>
void GridUpdate<T, Dim>::update_block(const Blocks<Dim>& blocks, std::size_t b, const T* arenas, const GridConstants<T, Dim>& constants) {
  if (recording_) contact_[b] = {}, contact_[b].obstacle.resize(model_.obstacles.size());
  if (wall_slot_[b] >= 0) return kernels_.sum(blocks, b, arenas, raw_.data() + std::size_t(wall_slot_[b]) * kernels_.own_size);
  T* own = grid_.data() + b * kernels_.own_size;
  kernels_.sum(blocks, b, arenas, own);
  kernels_.update_nodes(own, constants);
  if (obstacles_[b]) apply_obstacles(b);
}

template <class T, int Dim>
void GridUpdate<T, Dim>::apply_obstacles(std::size_t b) {
  T* own = grid_.data() + b * kernels_.own_size;
  for (const ObstacleNode<T, Dim>& node : *obstacles_[b]) {
    T* quad = own + 4 * node.node;
    if (!(quad[0] > mass_cut_off_)) continue;
    Vector<T, Dim> v;
    for (int c = 0; c < Dim; ++c) v[c] = quad[1 + c];
    const RigidObstacle& obstacle = model_.obstacles[node.obstacle];
    const auto done = apply_obstacle<T, Dim>(obstacle.kind, T(obstacle.coefficient), node.normal, quad[0], v);
    for (int c = 0; c < Dim; ++c) {
      if (kernels_.planes == 2) quad[cells * 4 + 1 + c] += v[c] - quad[1 + c];
      quad[1 + c] = v[c];
    }
    if (recording_)
      add<decltype(done.impulse.a), Dim>(contact_[b].obstacle[node.obstacle], done.impulse.a),
          contact_[b].friction += double(done.friction_work);
  }
}

template <class T, int Dim>
void GridUpdate<T, Dim>::update_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) {
  const Node first = first_node<Dim>(blocks.index[b]);
  const auto sums_at = [&](int block, int own) -> const T* {
    if (block < 0 || wall_slot_[std::size_t(block)] < 0) return nullptr;
    return raw_.data() + std::size_t(wall_slot_[std::size_t(block)]) * kernels_.own_size + 4 * own;
  };
  const auto raw = [&](const Node& node) {
    NodeSums<T, Dim> sum{};
    const auto at = locate<Dim>(blocks, b, first, node);
    const T* quad = sums_at(at.block, at.own);
    if (!quad) return sum;
    sum.mass = quad[0];
    for (int c = 0; c < Dim; ++c) {
      const T impulse = kernels_.planes == 2 ? quad[cells * 4 + 1 + c] : T(0);
      sum.momentum[c] = quad[1 + c] + impulse + sum.mass * constants.gravity_step[c];
    }
    return sum;
  };
  bool inside = false;  // whether the node asked for is one of the domain: what happens at ghosts is an image and counts not
  const auto obstacles = [&](const Node& node, T mass, Vector<T, Dim>& v) {
    const auto at = locate<Dim>(blocks, b, first, node);
    if (at.block < 0 || !obstacles_[std::size_t(at.block)]) return;
    for (const ObstacleNode<T, Dim>& o : *obstacles_[std::size_t(at.block)]) {
      if (int(o.node) != at.own) continue;
      const RigidObstacle& obstacle = model_.obstacles[o.obstacle];
      const auto done = apply_obstacle<T, Dim>(obstacle.kind, T(obstacle.coefficient), o.normal, mass, v);
      if (recording_ && inside)
        add<decltype(done.impulse.a), Dim>(contact_[b].obstacle[o.obstacle], done.impulse.a),
            contact_[b].friction += double(done.friction_work);
    }
  };
  const WallUpdate<T, Dim, decltype(raw), decltype(obstacles)> walls(walls_, raw, obstacles, mass_cut_off_);
  T* out = grid_.data() + b * kernels_.own_size;
  const T* own_raw = sums_at(int(b), 0);
  for (int own = 0; own < cells; ++own) {
    const Node node = node_of<Dim>(first, own);
    inside = true;
    bool reached = true;  // stencils end one node (cubic: with weight zero two) beyond a face
    for (int d = 0; d < Dim; ++d) {
      const int i = node[std::size_t(d)], n = walls_.cells[std::size_t(d)];
      inside = inside && i >= 0 && i <= n, reached = reached && i >= -1 && i <= n + 1;
    }
    NodeContact<T, Dim> contact;
    Vector<T, Dim> v{};
    if (reached) v = walls.velocity(node, recording_ && inside ? &contact : nullptr);
    const T mass = own_raw[4 * own];
    out[4 * own] = mass;
    for (int c = 0; c < Dim; ++c) {
      out[4 * own + 1 + c] = v[c];
      if (kernels_.planes == 2) out[cells * 4 + 4 * own + 1 + c] = mass > mass_cut_off_ ? v[c] - own_raw[4 * own + 1 + c] / mass : T(0);
    }
    if (!recording_ || !inside) continue;
    for (std::size_t f = 0; f < 2 * Dim; ++f) add<decltype(contact.impulse[f]), Dim>(contact_[b].face[f], contact.impulse[f]);
    contact_[b].friction += double(contact.friction_work);
  }
}

template <class T, int Dim>
BlockContact GridUpdate<T, Dim>::contact() const {
  BlockContact total;
  total.obstacle.resize(model_.obstacles.size());
  for (const BlockContact& block : contact_) {
    for (std::size_t f = 0; f < 6; ++f) add<Point, 3>(total.face[f], block.face[f]);
    for (std::size_t o = 0; o < block.obstacle.size(); ++o) add<Point, 3>(total.obstacle[o], block.obstacle[o]);
    total.friction += block.friction;
  }
  return total;
}

template class GridUpdate<float, 2>;
template class GridUpdate<float, 3>;
template class GridUpdate<double, 2>;
template class GridUpdate<double, 3>;

}  // namespace jaxmpm
