#pragma once
// Adjoint of the grid update on a device (solvers/grid_adjoint.hpp): a team a block, a thread a node. What passes through the walls' mirror
// images is added to its nodes in any order, by atomics.
#include "contact/wall_adjoint.hpp"
#include "kernels/adjoint/grid.hpp"
#include "kernels/device/adjoint/contract.hpp"
#include "kernels/device/grid.hpp"

namespace jaxmpm {

/// Where the derivatives go.
template <class T>
struct GridBarTables {
  T* by_sums;         // [block][own]
  T* by_velocity;     // [wall block][own node][4]: by the velocities of nodes near faces, from component 1 on
  double* constants;  // ConstantBars
  ConstantBars places;
  double dt, by_damping;  // what derivatives by Δt g, and by the part of the velocity that damping takes, are multiplied by
};

/// One thread's derivatives by gravity's step and damping's part.
template <int Dim>
struct PullBars {
  double by_pull[Dim] = {}, by_part = 0;

  template <class Team, class T>
  JAXMPM_INLINE void give(const Team& team, const GridBarTables<T>& to) const {
    for (int c = 0; c <= Dim; ++c) {
      const double sum = team_sum(team, c < Dim ? by_pull[c] : by_part);
      if (team.team_rank() > 0 || sum == 0) continue;
      if (c < Dim) Kokkos::atomic_add(to.constants + ConstantBars::gravity + c, to.dt * sum);
      else Kokkos::atomic_add(to.constants + ConstantBars::damping, to.by_damping * sum);
    }
  }
};

/// Adjoint of the obstacles that hold own node `own` of a block, which act one after another: `start` is the velocity before the first,
/// `bar` is by the velocity after the last, then by `start`.
template <class T, int Dim>
JAXMPM_FUNCTION void obstacle_chain(const GridTables<T, Dim>& table, const GridBarTables<T>& to, int block, int own,
                                    const Vector<T, Dim>& start, Vector<T, Dim>& bar) {
  const std::uint32_t begin = table.first_obstacle_node[block], end = table.first_obstacle_node[block + 1];
  for (std::uint32_t k = end; k-- > begin;) {
    const ObstacleNode<T, Dim>& node = table.obstacle_nodes[k];
    if (int(node.node) != own) continue;
    Vector<T, Dim> v = start;  // before this one
    for (std::uint32_t j = begin; j < k; ++j) {
      const ObstacleNode<T, Dim>& other = table.obstacle_nodes[j];
      if (int(other.node) != own) continue;
      const ObstacleLaw<T> law = table.obstacle_laws[other.obstacle];
      apply_obstacle<T, Dim>(law.kind, law.coefficient, other.normal, T(1), v);
    }
    const ObstacleLaw<T> law = table.obstacle_laws[node.obstacle];
    const T by = obstacle_adjoint<T, Dim>(law.kind, law.coefficient, node.normal, v, bar);
    if (by != T(0)) Kokkos::atomic_add(to.constants + to.places.obstacle() + int(node.obstacle), double(by));
  }
}

/// Sums what the tiles found by the nodes' velocities and turns it into derivatives by the nodes' sums; near faces only as far as it does
/// not pass through the velocity, which WallNodesAdjoint sees to.
template <class Sch, class Space>
struct NodesAdjoint {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  using V = Vector<T, Dim>;
  GridTables<T, Dim> table;
  GridConstants<T, Dim> constants;
  GridBarTables<T> to;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const auto b = std::size_t(team.league_rank());
    PullBars<Dim> mine;
    team_for(team, Sch::Shape::cells, [&](int own) { update(b, own, mine); });
    mine.give(team, to);
  }

 private:
  JAXMPM_FUNCTION void update(std::size_t b, int own, PullBars<Dim>& mine) const {
    T bar[2][4] = {};
    ArenaSums<Sch>{table}.add(b, own, bar);
    const T* sum = table.sums + b * Sch::own_size + 4 * own;
    const T* impulse = sum + (Sch::planes - 1) * Sch::own_plane;
    const int slot = table.wall_slot[b];
    if (slot >= 0 && table.walls.near_face(node_of<Dim>(first_node<Dim>(table.index[b]), own))) {
      take_out(sum, std::size_t(slot), own, bar);
    } else {
      contact_and_damping(int(b), own, sum, impulse, bar, mine);
      const V by_pull = update_node_adjoint<Sch>(sum, impulse, constants, bar[0], bar[Sch::planes - 1]);
      for (int c = 0; c < Dim; ++c) mine.by_pull[c] += double(by_pull[c]);
    }
    write_node<Sch>(bar, own, to.by_sums + b * Sch::own_size);
  }

  /// Hands the derivatives by the velocity over, FLIP's Δv = v − p/m included; leaves those by the node's own sums in that division.
  JAXMPM_INLINE void take_out(const T* sum, std::size_t slot, int own, T (&bar)[2][4]) const {
    T* by_v = to.by_velocity + (slot * std::size_t(Sch::Shape::cells) + std::size_t(own)) * 4;
    T direct[4] = {};
    const bool changes = Sch::flip && sum[0] > constants.mass_cut_off;
    for (int c = 1; c <= Dim; ++c) {
      by_v[c] = bar[0][c];
      if (!changes) continue;
      by_v[c] += bar[1][c];
      direct[c] = -bar[1][c] / sum[0], direct[0] += bar[1][c] * sum[c] / (sum[0] * sum[0]);
    }
    for (int c = 0; c < 4; ++c) bar[0][c] = direct[c], bar[1][c] = T(0);
  }

  /// Adjoint of obstacles and of damping's part; `bar` is by the velocity after, then before them.
  JAXMPM_INLINE void contact_and_damping(int b, int own, const T* sum, const T* impulse, T (&bar)[2][4], PullBars<Dim>& mine) const {
    if (!(sum[0] > constants.mass_cut_off)) return;
    const V pull = pull_at<T, Dim>(constants, nullptr, b, own);
    V free, by;
    for (int c = 0; c < Dim; ++c) {
      free[c] = (sum[1 + c] + (Sch::flip ? impulse[1 + c] : T(0))) / sum[0] + pull[c];
      by[c] = bar[0][1 + c] + (Sch::flip ? bar[1][1 + c] : T(0));  // Δv follows v through the contact
    }
    if (table.first_obstacle_node[b] < table.first_obstacle_node[b + 1]) {
      V start;
      for (int c = 0; c < Dim; ++c) start[c] = free[c] - constants.damped * free[c];
      obstacle_chain<T, Dim>(table, to, b, own, start, by);
      for (int c = 0; c < Dim; ++c) bar[0][1 + c] = by[c] - (Sch::flip ? bar[1][1 + c] : T(0));
    }
    for (int c = 0; c < Dim; ++c) mine.by_part -= double(by[c] * free[c]);
  }
};

/// Adjoint of WallNodes: passes the derivatives by the velocities of nodes near faces on to the sums that these came from.
template <class T, int Dim, int planes, class Space>
struct WallNodesAdjoint {
  using Node = Index<Dim>;
  using V = Vector<T, Dim>;
  static constexpr int cells = BlockShape<Dim, 2>::cells, around = BlockShape<Dim, 2>::neighbours, plane = 4 * cells;
  GridTables<T, Dim> table;
  GridConstants<T, Dim> constants;
  GridBarTables<T> to;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const std::size_t w = std::size_t(team.league_rank());
    PullBars<Dim> mine;
    team_for(team, cells, [&](int own) { update(w, own, mine); });
    mine.give(team, to);
  }

 private:
  JAXMPM_FUNCTION void update(std::size_t w, int own, PullBars<Dim>& mine) const {
    const std::size_t b = table.wall_block[w];
    const int* neighbours = table.neighbour + b * around;
    const Node first = first_node<Dim>(table.index[b]), node = node_of<Dim>(first, own);
    if (!table.walls.near_face(node) || !standing<T, Dim>(table.walls, node).reached) return;
    const WallSums<T, Dim> raw{neighbours, table.wall_slot, table.raw, planes, first, constants, nullptr};
    const auto no_obstacles = [](const Node&, T, V&) {};
    const auto obstacles = [&](const Node& asked, const V& start, V& bar) {
      const Place<Dim> at = locate<Dim>(neighbours, first, asked);
      if (at.block >= 0) obstacle_chain<T, Dim>(table, to, at.block, at.own, start, bar);
    };
    const auto add = [&](const Node& image, T by_mass, const V& by_momentum) {
      const Place<Dim> at = locate<Dim>(neighbours, first, image);
      if (const T* sum = raw.quad(at.block, at.own)) this->add(at, sum, by_mass, by_momentum, mine);
    };
    const auto add_coefficient = [&](int segment, T by) {
      if (by != T(0)) Kokkos::atomic_add(to.constants + ConstantBars::segment + segment, double(by));
    };
    const auto add_velocity = [&](int face, int c, T by) {
      if (by != T(0)) Kokkos::atomic_add(to.constants + ConstantBars::wall_velocity + 3 * face + c, double(by));
    };
    const WallAdjoint<T, Dim, WallSums<T, Dim>, decltype(no_obstacles), decltype(obstacles), decltype(add), decltype(add_coefficient),
                      decltype(add_velocity)>
        walls(table.walls, raw, no_obstacles, constants.mass_cut_off, obstacles, add, add_coefficient, add_velocity);
    const T* by = to.by_velocity + (w * std::size_t(cells) + std::size_t(own)) * 4 + 1;
    V bar;
    for (int c = 0; c < Dim; ++c) bar[c] = by[c];
    walls.velocity(node, bar);
  }

  /// Adjoint of WallSums at one node: P = (p + impulse + m Δt g)/(1 + ζΔt). `sum`: the node's raw sums.
  JAXMPM_INLINE void add(const Place<Dim>& at, const T* sum, T by_mass, const V& by_momentum, PullBars<Dim>& mine) const {
    const V pull = pull_at<T, Dim>(constants, nullptr, at.block, at.own);
    T* by_sums = to.by_sums + std::size_t(at.block) * std::size_t(planes * plane) + 4 * at.own;
    for (int c = 0; c < Dim; ++c) {
      const T by_undamped = by_momentum[c] - constants.damped * by_momentum[c];
      by_mass += by_undamped * pull[c];
      Kokkos::atomic_add(by_sums + 1 + c, by_undamped);
      if (planes == 2) Kokkos::atomic_add(by_sums + plane + 1 + c, by_undamped);
      mine.by_pull[c] += double(sum[0] * by_undamped);
      const T momentum = sum[1 + c] + (planes == 2 ? sum[plane + 1 + c] : T(0));
      mine.by_part -= double(by_momentum[c] * (momentum + sum[0] * pull[c]));
    }
    Kokkos::atomic_add(by_sums, by_mass);
  }
};

}  // namespace jaxmpm
