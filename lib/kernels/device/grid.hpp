#pragma once
// The grid update on a device (Eqs 13–14): a team a block, a thread a node. The arenas that reach a node are added in the order of
// kernels/grid.hpp; nothing is written by two threads.
#include "kernels/device/stencil.hpp"

namespace jaxmpm {

/// An obstacle's contact law in the precision of the step.
template <class T>
struct ObstacleLaw {
  deck::ContactKind kind;
  T coefficient;
};

/// The blocks of a sort and what is near them, in a device's memory (state/blocks.hpp, solvers/contact_blocks.hpp).
template <class T, int Dim>
struct GridTables {
  std::size_t blocks, wall_blocks;
  const Index<Dim>* index;
  const int* neighbour;
  const std::uint32_t* first_contribution;
  const Contribution* contributions;
  const int* wall_slot;
  const std::uint32_t* wall_block;
  const std::uint32_t* first_obstacle_node;  // [block + 1]
  const ObstacleNode<T, Dim>* obstacle_nodes;
  const ObstacleLaw<T>* obstacle_laws;
  Walls<T, Dim> walls;
  const T* arenas;
  T *raw, *grid;    // [wall block][own], [block][own]
  double* contact;  // [block][contact_size]: impulse of each face and obstacle (three values each), friction; null: not recorded
  std::size_t contact_size;

  static constexpr int faces = 6;
  JAXMPM_INLINE void record(std::size_t block, int place, const T* impulse) const {
    for (int c = 0; c < Dim; ++c)
      if (impulse[c] != T(0)) Kokkos::atomic_add(contact + block * contact_size + std::size_t(3 * place + c), double(impulse[c]));
  }
  JAXMPM_INLINE void record_friction(std::size_t block, T work) const {
    if (work != T(0)) Kokkos::atomic_add(contact + (block + 1) * contact_size - 1, double(work));
  }
  JAXMPM_INLINE void record(std::size_t block, const ObstacleNode<T, Dim>& node, const ObstacleContact<T, Dim>& done) const {
    if (!contact) return;
    record(block, faces + int(node.obstacle), done.impulse.a);
    record_friction(block, done.friction_work);
  }
};

/// Sums of every node; where no wall is near also the velocities, with obstacles.
template <class Sch, class Space>
struct SumNodes {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  GridTables<T, Dim> table;
  GridConstants<T, Dim> constants;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const auto b = std::size_t(team.league_rank());
    team_for(team, Sch::Shape::cells, [&](int own) { update(b, own); });
  }

 private:
  /// Arena node of the neighbour at `offset` that lies on own node `own`, −1 for none.
  static JAXMPM_INLINE int in_arena(const NeighbourOffset<Dim>& offset, int own) {
    constexpr int B = Sch::Shape::B;
    const int step[3] = {offset.a, offset.b, offset.c};
    int node[3] = {0, 0, 0};
    for (int d = Dim - 1; d >= 0; --d, own /= B) {
      const Overlap o = overlap<B, Sch::S>(step[d]);
      const int i = own % B - o.from;
      if (i < 0 || i >= o.count) return -1;
      node[d] = o.in_arena + i;
    }
    return Sch::Shape::arena_node(node[0], node[1], node[2]);
  }

  JAXMPM_INLINE void update(std::size_t b, int own) const {
    T sum[2][4] = {};
    for (std::uint32_t k = table.first_contribution[b]; k < table.first_contribution[b + 1]; ++k) {
      const Contribution from = table.contributions[k];
      const int node = in_arena(NeighbourOffset<Dim>(int(from.neighbour)), own);
      if (node < 0) continue;
      const T* arena = table.arenas + std::size_t(from.tile) * Sch::arena_size + 4 * node;
      for (int plane = 0; plane < Sch::planes; ++plane)
        for (int c = 0; c < 4; ++c) sum[plane][c] += arena[plane * Sch::arena_plane + c];
    }
    const int slot = table.wall_slot[b];
    if (slot < 0) finish(b, own, sum);
    T* out = (slot < 0 ? table.grid + b * Sch::own_size : table.raw + std::size_t(slot) * Sch::own_size) + 4 * own;
    for (int plane = 0; plane < Sch::planes; ++plane)
      for (int c = 0; c < 4; ++c) out[plane * Sch::own_plane + c] = sum[plane][c];
  }

  JAXMPM_INLINE void finish(std::size_t b, int own, T sum[2][4]) const {
    update_node<Sch>(sum[0], sum[Sch::planes - 1], constants);
    for (std::uint32_t k = table.first_obstacle_node[b]; k < table.first_obstacle_node[b + 1]; ++k) {
      const ObstacleNode<T, Dim>& node = table.obstacle_nodes[k];
      if (int(node.node) != own) continue;
      const ObstacleLaw<T> law = table.obstacle_laws[node.obstacle];
      table.record(b, node,
                   push_node<T, Dim>(law.kind, law.coefficient, node.normal, constants.mass_cut_off, sum[0], Sch::flip ? sum[1] : nullptr));
    }
  }
};

/// Velocities of the blocks at walls, from the sums.
template <class T, int Dim, int planes, class Space>
struct WallNodes {
  using Node = Index<Dim>;
  static constexpr int cells = BlockShape<Dim, 2>::cells, around = BlockShape<Dim, 2>::neighbours;
  GridTables<T, Dim> table;
  GridConstants<T, Dim> constants;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const std::size_t b = table.wall_block[team.league_rank()];
    team_for(team, cells, [&](int own) { update(b, own); });
  }

 private:
  JAXMPM_FUNCTION void update(std::size_t b, int own) const {
    const int* neighbours = table.neighbour + b * around;
    const Node first = first_node<Dim>(table.index[b]);
    const WallSums<T, Dim> raw{neighbours, table.wall_slot, table.raw, planes, first, constants.gravity_step};
    const Node node = node_of<Dim>(first, own);
    const NodeStanding at = standing<T, Dim>(table.walls, node);
    const bool recorded = table.contact && at.inside;
    const auto obstacles = [&](const Node& asked, T mass, Vector<T, Dim>& v) {
      const Place<Dim> place = locate<Dim>(neighbours, first, asked);
      if (place.block < 0) return;
      for (std::uint32_t k = table.first_obstacle_node[place.block]; k < table.first_obstacle_node[place.block + 1]; ++k) {
        const ObstacleNode<T, Dim>& o = table.obstacle_nodes[k];
        if (int(o.node) != place.own) continue;
        const ObstacleLaw<T> law = table.obstacle_laws[o.obstacle];
        const auto done = apply_obstacle<T, Dim>(law.kind, law.coefficient, o.normal, mass, v);
        if (recorded) table.record(b, o, done);
      }
    };
    const WallUpdate<T, Dim, WallSums<T, Dim>, decltype(obstacles)> walls(table.walls, raw, obstacles, constants.mass_cut_off);
    NodeContact<T, Dim> contact;
    Vector<T, Dim> v{};
    if (at.reached) v = walls.velocity(node, recorded ? &contact : nullptr);
    write_wall_node(raw.quad(int(b), own), v, constants.mass_cut_off, planes, own, table.grid + b * std::size_t(planes * cells * 4));
    if (!recorded) return;
    for (std::size_t f = 0; f < 2 * Dim; ++f) table.record(b, int(f), &contact.impulse[f][0]);
    table.record_friction(b, contact.friction_work);
  }
};

/// total[k]: sum of entry k of the contact over all blocks, a team an entry.
template <class Space>
struct SumContact {
  const double* contact;
  std::size_t blocks, contact_size;
  double* total;
  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const auto entry = std::size_t(team.league_rank());
    double sum = 0;
    team_for(team, int(blocks), [&](int b) { sum += contact[std::size_t(b) * contact_size + entry]; });
    sum = team_sum(team, sum);
    if (team.team_rank() == 0) total[entry] = sum;
  }
};

}  // namespace jaxmpm
