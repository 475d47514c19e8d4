#include "solvers/grid_adjoint.hpp"

#include "core/parallel_host.hpp"
#include "fields/body_force.hpp"

namespace jaxmpm {

void GridBars::clear(const Model& model, std::size_t segments) {
  gravity = {}, damping = 0, wall_velocity = {};
  segment.assign(segments, 0), obstacle.assign(model.obstacles.size(), 0);
  body_force.assign(model.body_force ? model.body_force->slopes() : 0, 0);
}

void GridBars::add(const GridBars& block, double dt, double by_damping) {
  for (std::size_t c = 0; c < 3; ++c) gravity[c] += dt * block.gravity[c];
  damping += by_damping * block.damping;
  for (std::size_t k = 0; k < body_force.size(); ++k) body_force[k] += dt * block.body_force[k];
  for (std::size_t f = 0; f < wall_velocity.size(); ++f)
    for (std::size_t c = 0; c < 3; ++c) wall_velocity[f][c] += block.wall_velocity[f][c];
  for (std::size_t k = 0; k < segment.size(); ++k) segment[k] += block.segment[k];
  for (std::size_t k = 0; k < obstacle.size(); ++k) obstacle[k] += block.obstacle[k];
}

template <class T, int Dim>
void GridAdjoint<T, Dim>::update(const Blocks<Dim>& blocks, const T* arenas, double dt, double time) {
  const GridConstants<T, Dim> constants = forward_.constants(dt);
  const ContactBlocks<T, Dim>& contact = forward_.contact_blocks();
  const std::size_t own_size = kernels_.own_size;
  own_.resize(blocks.count() * own_size), block_.resize(blocks.count()), near_face_.resize(blocks.count());
  halo_.resize(contact.wall_blocks().size());
  parallel_for_host("jaxmpm::grid_adjoint", blocks.count(), [&](std::size_t b) {
    T* own = own_.data() + b * own_size;
    kernels_.sum(blocks, b, arenas, own);
    block_[b].clear(model_, segments());
    near_face_[b].clear();
    if (contact.wall_slot()[b] >= 0) wall_block_adjoint(blocks, b, constants);
    if (contact.obstacles(b)) obstacles_adjoint(blocks, b, constants);
    if (model_.body_force || model_.method.damping > 0) constants_adjoint(blocks, b, constants, time);
    const V by_pull = adjoint_.update_nodes(forward_.sums(b), constants, own);
    for (int c = 0; c < Dim; ++c) block_[b].gravity[std::size_t(c)] = double(by_pull[c]);
    for (const NearFace& node : near_face_[b]) {
      T* by_sums = own + 4 * node.own;
      by_sums[0] += node.direct.mass;  // what is there already came through the mean change of volume
      for (int c = 0; c < Dim; ++c) by_sums[1 + c] = node.direct.momentum[c];
    }
  });
  parallel_for_host("jaxmpm::walls_adjoint", contact.wall_blocks().size(),
                    [&](std::size_t w) { collect_wall_block(blocks, contact.wall_blocks()[w], constants, time); });
  const double slowing = 1 + model_.method.damping * dt;                                 // the part taken is ζΔt/(1 + ζΔt)
  for (const GridBars& block : block_) total_.add(block, dt, dt / (slowing * slowing));  // in the order of blocks
}

/// (p + impulse)/m + Δt (g + b): the velocity of a node before damping takes its part.
template <class T, int Dim>
auto GridAdjoint<T, Dim>::undamped(const T* sum, const V& pull) const -> V {
  V v;
  for (int c = 0; c < Dim; ++c) v[c] = (sum[1 + c] + (kernels_.planes == 2 ? sum[cells * 4 + 1 + c] : T(0))) / sum[0] + pull[c];
  return v;
}

/// Adds the derivatives by the body force's numbers, of those by Δt b at a block's nodes. The force is asked for where something passes
/// through a node alone: elsewhere, as in the forward update, it need not be finite.
template <class T, int Dim>
void GridAdjoint<T, Dim>::add_by_pull(const Blocks<Dim>& blocks, std::size_t b, const std::array<V, cells>& by_pull, double time) {
  if (!model_.body_force) return;
  const Node first = first_node<Dim>(blocks.index[b]);
  const BodyForce::Loan field(*model_.body_force);
  for (int own = 0; own < cells; ++own) {
    Point by{};
    for (int c = 0; c < Dim; ++c) by[std::size_t(c)] = double(by_pull[std::size_t(own)][c]);
    if (by != Point{}) field.add_slopes(forward_.place(node_of<Dim>(first, own)), time, by, block_[b].body_force.data());
  }
}

/// Derivatives by damping and by the body force's numbers, at the nodes of a block that no wall is near.
template <class T, int Dim>
void GridAdjoint<T, Dim>::constants_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants, double time) {
  std::array<V, cells> by_pull{};
  for (int own = 0; own < cells; ++own) {
    const T *sum = forward_.sums(b) + 4 * own, *bar = own_.data() + b * kernels_.own_size + 4 * own;
    if (!(sum[0] > constants.mass_cut_off)) continue;
    const V v = undamped(sum, forward_.pull(constants, b, own));
    for (int c = 0; c < Dim; ++c) {
      const T by_v = bar[1 + c] + (kernels_.planes == 2 ? bar[cells * 4 + 1 + c] : T(0));
      block_[b].damping -= double(by_v * v[c]);
      by_pull[std::size_t(own)][c] = by_v - constants.damped * by_v;
    }
  }
  add_by_pull(blocks, b, by_pull, time);
}

/// Adjoint of the obstacles at one node, which act one after another: `start` is the velocity before the first, `bar` is by the velocity
/// after the last, then by `start`.
template <class T, int Dim>
void GridAdjoint<T, Dim>::obstacle_chain(std::size_t block, int own, const V& start, V& bar, GridBars& bars) const {
  const auto* nodes = forward_.contact_blocks().obstacles(block);
  if (!nodes) return;
  std::vector<std::pair<const ObstacleNode<T, Dim>*, V>> chain;  // with the velocity before each
  V v = start;
  for (const ObstacleNode<T, Dim>& node : *nodes) {
    if (int(node.node) != own) continue;
    chain.emplace_back(&node, v);
    const RigidObstacle& o = model_.obstacles[node.obstacle];
    apply_obstacle<T, Dim>(o.kind, T(o.coefficient), node.normal, T(1), v);
  }
  for (auto link = chain.rbegin(); link != chain.rend(); ++link) {
    const RigidObstacle& o = model_.obstacles[link->first->obstacle];
    bars.obstacle[link->first->obstacle] +=
        double(obstacle_adjoint<T, Dim>(o.kind, T(o.coefficient), link->first->normal, link->second, bar));
  }
}

/// Adjoint of push_node for the nodes of a block that no wall is near.
template <class T, int Dim>
void GridAdjoint<T, Dim>::obstacles_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) {
  const Node first = first_node<Dim>(blocks.index[b]);
  const bool at_wall = forward_.contact_blocks().wall_slot()[b] >= 0;
  const bool with_change = kernels_.planes == 2;
  const T* sums = forward_.sums(b);
  T* bars = own_.data() + b * kernels_.own_size;
  std::array<bool, cells> done{};
  for (const ObstacleNode<T, Dim>& node : *forward_.contact_blocks().obstacles(b)) {
    const T* sum = sums + 4 * node.node;
    if (done[node.node] || !(sum[0] > constants.mass_cut_off)) continue;
    done[node.node] = true;
    if (at_wall && forward_.walls().near_face(node_of<Dim>(first, int(node.node)))) continue;
    T* by_v = bars + 4 * node.node + 1;
    const T* by_change = bars + cells * 4 + 4 * node.node + 1;
    V start = undamped(sum, forward_.pull(constants, b, int(node.node))), bar;
    for (int c = 0; c < Dim; ++c) {
      start[c] -= constants.damped * start[c];
      bar[c] = by_v[c] + (with_change ? by_change[c] : T(0));  // Δv follows v through the contact
    }
    obstacle_chain(b, int(node.node), start, bar, block_[b]);
    for (int c = 0; c < Dim; ++c) by_v[c] = bar[c] - (with_change ? by_change[c] : T(0));
  }
}

/// Place in a halo of the node that lies at `at` from the first of the block that it is around.
template <class T, int Dim>
int GridAdjoint<T, Dim>::halo_node(const Node& at) {
  int place = 0;
  for (std::size_t d = 0; d < Dim; ++d) place = place * side + at[d] + reach;
  return place;
}

template <class T, int Dim>
void GridAdjoint<T, Dim>::Halo::add(const Node& at, T by_mass, const V& by_momentum) {
  const int place = halo_node(at);
  std::uint16_t& row = touched[std::size_t(place / side)];
  const auto bit = std::uint16_t(1u << (place % side));
  Sum& sum = by[std::size_t(place)];
  if (!(row & bit)) sum = {};
  row |= bit;
  sum.mass += by_mass;
  for (int c = 0; c < Dim; ++c) sum.momentum[c] += by_momentum[c];
}

/// Adjoint of update_wall_block: takes the derivatives by the velocities of nodes near faces out of own_ and passes them to the node sums
/// around the block, in its halo. What does not pass through the velocity, FLIP's own division, goes to near_face_.
template <class T, int Dim>
void GridAdjoint<T, Dim>::wall_block_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) {
  const Node first = first_node<Dim>(blocks.index[b]);
  const int* neighbours = blocks.neighbour.data() + b * around;
  const WallSums<T, Dim> raw = forward_.wall_sums(blocks, b, constants);
  Halo& halo = halo_[std::size_t(forward_.contact_blocks().wall_slot()[b])];
  halo.touched.fill(0);
  const auto no_obstacles = [](const Node&, T, V&) {};
  const auto obstacles = [&](const Node& node, const V& start, V& bar) {
    const Place<Dim> at = locate<Dim>(neighbours, first, node);
    if (at.block >= 0) obstacle_chain(std::size_t(at.block), at.own, start, bar, block_[b]);
  };
  const auto add = [&](const Node& node, T by_mass, const V& by_momentum) {
    Node at = node;
    for (std::size_t d = 0; d < Dim; ++d) at[d] -= first[d];
    halo.add(at, by_mass, by_momentum);
  };
  const auto add_coefficient = [&](int segment, T by) { block_[b].segment[std::size_t(segment)] += double(by); };
  const auto add_velocity = [&](int face, int c, T by) { block_[b].wall_velocity[std::size_t(face)][std::size_t(c)] += double(by); };
  const WallAdjoint<T, Dim, WallSums<T, Dim>, decltype(no_obstacles), decltype(obstacles), decltype(add), decltype(add_coefficient),
                    decltype(add_velocity)>
      walls(forward_.walls(), raw, no_obstacles, constants.mass_cut_off, obstacles, add, add_coefficient, add_velocity);
  T* bars = own_.data() + b * kernels_.own_size;
  const T* sums = forward_.sums(b);
  for (int own = 0; own < cells; ++own) {
    const Node node = node_of<Dim>(first, own);
    if (!forward_.walls().near_face(node) || !(sums[4 * own] > 0)) continue;
    V bar;
    const Sum direct = take_out(sums, constants.mass_cut_off, own, bars, bar);
    if (kernels_.planes == 2) near_face_[b].push_back({own, direct});
    if (standing<T, Dim>(forward_.walls(), node).reached) walls.velocity(node, bar);
  }
}

/// Takes the derivatives of one node out of own_: those by its velocity, FLIP's Δv = v − p/m included, go to `bar`; those by its own sums
/// in that division are returned.
template <class T, int Dim>
auto GridAdjoint<T, Dim>::take_out(const T* sums, T cut_off, int own, T* bars, V& bar) const -> Sum {
  Sum direct{};
  T *by_v = bars + 4 * own + 1, *by_change = by_v + cells * 4;
  const T* sum = sums + 4 * own;
  for (int c = 0; c < Dim; ++c) {
    bar[c] = by_v[c], by_v[c] = T(0);
    if (kernels_.planes == 1) continue;
    if (sum[0] > cut_off) {  // else Δv is zero whatever v is
      bar[c] += by_change[c];
      direct.momentum[c] = -by_change[c] / sum[0], direct.mass += by_change[c] * sum[1 + c] / (sum[0] * sum[0]);
    }
    by_change[c] = T(0);
  }
  return direct;
}

/// Calls f(own, derivatives) for the own nodes of a block that the halo of neighbour m touched, ascending.
template <class T, int Dim>
template <class F>
void GridAdjoint<T, Dim>::for_each_own_node_in_reach(int m, const Halo& halo, F f) {
  std::array<int, 3> from{0, 0, 0}, to{1, 1, 1}, offset{};  // own nodes, and where the neighbour has them
  for (std::size_t d = Dim, rest = std::size_t(m); d-- > 0; rest /= 3) {
    const int step = int(rest % 3) - 1;
    from[d] = step > 0 ? B - reach : 0, to[d] = step < 0 ? reach : B, offset[d] = -B * step;
  }
  constexpr std::size_t along = Dim - 1;  // rows
  for (int i = from[0]; i < to[0]; ++i)
    for (int j = Dim == 3 ? from[1] : 0; j < (Dim == 3 ? to[1] : 1); ++j) {
      const int own = Dim == 3 ? BlockShape<Dim, 2>::own_node(i, j, from[along]) : BlockShape<Dim, 2>::own_node(i, from[along], 0);
      Node at{};
      at[0] = i + offset[0];
      if (Dim == 3) at[1] = j + offset[1];
      at[along] = from[along] + offset[along];
      const int place = halo_node(at);
      const unsigned row = unsigned(halo.touched[std::size_t(place / side)]) >> (place % side);
      for (unsigned left = row & ((1u << (to[along] - from[along])) - 1); left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        f(own + k, halo.by[std::size_t(place + k)]);
      }
    }
}

/// Adds the halos that reach a wall block, in the order of neighbours: P = (p + impulse + m Δt (g + b))/(1 + ζΔt).
template <class T, int Dim>
void GridAdjoint<T, Dim>::collect_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants,
                                             double time) {
  T* bars = own_.data() + b * kernels_.own_size;
  const T* sums = forward_.sums(b);
  std::array<V, cells> by_pull{};
  for (int m = 0; m < around; ++m) {
    const int other = blocks.neighbour[b * around + std::size_t(m)];
    const int slot = other < 0 ? -1 : forward_.contact_blocks().wall_slot()[std::size_t(other)];
    if (slot < 0) continue;
    for_each_own_node_in_reach(m, halo_[std::size_t(slot)], [&](int own, const Sum& by) {
      if (!(sums[4 * own] > 0)) return;
      const V pull = forward_.pull(constants, b, own);
      T* by_sums = bars + 4 * own;
      by_sums[0] += by.mass;
      for (int c = 0; c < Dim; ++c) {
        const T by_undamped = by.momentum[c] - constants.damped * by.momentum[c];
        by_sums[0] += by_undamped * pull[c];
        by_sums[1 + c] += by_undamped;
        if (kernels_.planes == 2) by_sums[cells * 4 + 1 + c] += by_undamped;
        by_pull[std::size_t(own)][c] += sums[4 * own] * by_undamped;
        block_[b].gravity[std::size_t(c)] += double(sums[4 * own] * by_undamped);
        const T momentum = sums[4 * own + 1 + c] + (kernels_.planes == 2 ? sums[cells * 4 + 4 * own + 1 + c] : T(0));
        block_[b].damping -= double(by.momentum[c] * (momentum + sums[4 * own] * pull[c]));
      }
    });
  }
  add_by_pull(blocks, b, by_pull, time);
}

template class GridAdjoint<float, 2>;
template class GridAdjoint<float, 3>;
template class GridAdjoint<double, 2>;
template class GridAdjoint<double, 3>;

}  // namespace jaxmpm
