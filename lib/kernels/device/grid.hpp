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
  const std::uint32_t *first_arena, *arena_tile;  // [block][neighbour] + 1: the tiles there whose arenas reach the block
  const int* wall_slot;
  const std::uint32_t* wall_block;
  const std::uint32_t* first_obstacle_node;  // [block + 1]
  const ObstacleNode<T, Dim>* obstacle_nodes;
  const ObstacleLaw<T>* obstacle_laws;
  Walls<T, Dim> walls;
  const T* arenas;
  T *raw, *grid;     // [wall block][own], [block][own]
  T* sums;           // [block][own]: what the arenas add up to, for the adjoint; null: not kept
  double* contact;   // [block][contact_size]: impulse of each face and obstacle, three values each; null: not recorded
  double* friction;  // [block]: work of friction since the last sort, added up; null: not recorded
  std::size_t contact_size;

  static constexpr int faces = 6;
  JAXMPM_INLINE bool recording() const { return contact || friction; }
  JAXMPM_INLINE void record(std::size_t block, int place, const T* impulse) const {
    if (!contact) return;
    for (int c = 0; c < Dim; ++c)
      if (impulse[c] != T(0)) Kokkos::atomic_add(contact + block * contact_size + std::size_t(3 * place + c), double(impulse[c]));
  }
  JAXMPM_INLINE void record_friction(std::size_t block, T work) const {
    if (friction && work != T(0)) Kokkos::atomic_add(friction + block, double(work));
  }
  JAXMPM_INLINE void record(std::size_t block, const ObstacleNode<T, Dim>& node, const ObstacleContact<T, Dim>& done) const {
    record(block, faces + int(node.obstacle), done.impulse.a);
    record_friction(block, done.friction_work);
  }
};

/// The arenas that reach a node, added up.
template <class Sch>
struct ArenaSums {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, B = Sch::Shape::B;
  const GridTables<T, Dim>& table;

  /// Adds to the planes of own node `own` of block b.
  JAXMPM_INLINE void add(std::size_t b, int own, T (&sum)[2][4]) const {
    const int i = own / (B * B), j = own / B % B, k = own % B;  // 2D: i = 0
    const Reach x(i), y(j), z(k);
    for (int c = Dim == 2 ? 0 : x.from; c <= (Dim == 2 ? 0 : x.to); ++c)
      for (int d = y.from; d <= y.to; ++d)
        for (int e = z.from; e <= z.to; ++e) {
          const int m = ((Dim == 2 ? 0 : c + 1) * 3 + d + 1) * 3 + e + 1;
          if constexpr (Dim == 2) add_from(b, m, Sch::Shape::arena_node(in_arena(j, d), in_arena(k, e), 0), sum);
          else add_from(b, m, Sch::Shape::arena_node(in_arena(i, c), in_arena(j, d), in_arena(k, e)), sum);
        }
  }

 private:
  /// Along one axis, the neighbours whose arenas reach node `own` of a block: those at the distances from … to. It is node own + 1 − d B
  /// there.
  struct Reach {
    int from, to;
    explicit JAXMPM_INLINE Reach(int own) : from(own < Sch::S ? -1 : 0), to(own == B - 1 ? 1 : 0) {}
  };
  static JAXMPM_INLINE int in_arena(int own, int d) { return own + 1 - d * B; }

  /// Adds what the arenas of the neighbour m hold of a node, at `node` there.
  JAXMPM_INLINE void add_from(std::size_t b, int m, int node, T (&sum)[2][4]) const {
    const std::size_t entry = b * Sch::Shape::neighbours + std::size_t(m);
    for (std::uint32_t k = table.first_arena[entry]; k < table.first_arena[entry + 1]; ++k) {
      const T* arena = table.arenas + std::size_t(table.arena_tile[k]) * Sch::arena_size;
      for (int plane = 0; plane < Sch::planes; ++plane) {
        const Quad<T> given = quad_at(arena + plane * Sch::arena_plane, node);
        for (int c = 0; c < 4; ++c) sum[plane][c] += given.a[c];
      }
    }
  }
};

/// Writes the quads of a node to its block's own nodes.
template <class Sch>
JAXMPM_INLINE void write_node(const typename Sch::T (&quads)[2][4], int own, typename Sch::T* block) {
  for (int plane = 0; plane < Sch::planes; ++plane)
    quad_at(block + plane * Sch::own_plane, own) = {{quads[plane][0], quads[plane][1], quads[plane][2], quads[plane][3]}};
}

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
  JAXMPM_INLINE void update(std::size_t b, int own) const {
    T sum[2][4] = {};
    ArenaSums<Sch>{table}.add(b, own, sum);
    if (table.sums) write_node<Sch>(sum, own, table.sums + b * Sch::own_size);
    const int slot = table.wall_slot[b];
    if (slot < 0) finish(b, own, sum);
    T* out = slot < 0 ? table.grid + b * Sch::own_size : table.raw + std::size_t(slot) * Sch::own_size;
    write_node<Sch>(sum, own, out);
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
    const WallSums<T, Dim> raw{neighbours, table.wall_slot, table.raw, planes, first, constants, nullptr};
    const Node node = node_of<Dim>(first, own);
    const NodeStanding at = standing<T, Dim>(table.walls, node);
    const bool recorded = table.recording() && at.inside;
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
    if (at.reached) v = walls.velocity(node, table.recording() ? &contact : nullptr);
    write_wall_node(raw.quad(int(b), own), v, constants.mass_cut_off, planes, own, table.grid + b * std::size_t(planes * cells * 4));
    if (!table.recording()) return;
    for (std::size_t f = 0; f < 2 * Dim; ++f) table.record(b, int(f), &contact.impulse[f][0]);
    table.record_friction(b, contact.friction_work);
  }
};

/// total[k]: sum of column k of a table of `rows` rows, a team a column.
template <class Space>
struct SumColumns {
  const double* table;
  std::size_t rows, columns;
  double* total;
  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const auto column = std::size_t(team.league_rank());
    double sum = 0;
    team_for(team, int(rows), [&](int r) { sum += table[std::size_t(r) * columns + column]; });
    sum = team_sum(team, sum);
    if (team.team_rank() == 0) total[column] = sum;
  }
};

}  // namespace jaxmpm
