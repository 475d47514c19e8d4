#pragma once
// Nodes of the blocks at walls: where they lie, what their neighbours hold, and the update of one of them (docs/theory.md, "Grid update").
#include "contact/walls.hpp"
#include "kernels/grid.hpp"

namespace jaxmpm {

/// Coordinates of own node 0 of a block.
template <int Dim>
JAXMPM_FUNCTION Index<Dim> first_node(const Index<Dim>& block) {
  Index<Dim> node{};
  for (int d = 0; d < Dim; ++d) node[std::size_t(d)] = BlockShape<Dim, 2>::first_node(block[std::size_t(d)]);
  return node;
}

/// Coordinates of own node `own` of a block that starts at `first`.
template <int Dim>
JAXMPM_FUNCTION Index<Dim> node_of(const Index<Dim>& first, int own) {
  constexpr int B = BlockShape<Dim, 2>::B;
  Index<Dim> node = first;
  for (int d = Dim - 1; d >= 0; --d, own /= B) node[std::size_t(d)] += own % B;
  return node;
}

/// A node near a block: which active block holds it (Blocks::none where none does) and where.
template <int Dim>
struct Place {
  int block, own;
};

/// `around`: the block's row of Blocks::neighbour.
template <int Dim>
JAXMPM_FUNCTION Place<Dim> locate(const int* around, const Index<Dim>& first, const Index<Dim>& node) {
  constexpr int B = BlockShape<Dim, 2>::B;
  int neighbour = 0, own = 0;
  for (int d = 0; d < Dim; ++d) {
    const int local = node[std::size_t(d)] - first[std::size_t(d)], step = local < 0 ? 0 : (local >= B ? 2 : 1);
    neighbour = neighbour * 3 + step, own = own * B + local - (step - 1) * B;
  }
  return {around[neighbour], own};
}

/// Δt (g + b) at own node `own` of a block, m/s. `force`: Δt b of the nodes of all blocks, or null.
template <class T, int Dim>
JAXMPM_FUNCTION Vector<T, Dim> pull_at(const GridConstants<T, Dim>& constants, const T* force, int block, int own) {
  Vector<T, Dim> pull = constants.gravity_step;
  const std::size_t node = std::size_t(block) * std::size_t(BlockShape<Dim, 2>::cells) + std::size_t(own);
  for (int c = 0; force && c < Dim; ++c) pull[c] += force[node * Dim + std::size_t(c)];
  return pull;
}

/// Mass and predicted momentum near a block, from the sums of the blocks at walls: the `Raw` of WallUpdate.
template <class T, int Dim>
struct WallSums {
  static constexpr int plane = BlockShape<Dim, 2>::cells * 4;
  const int* around;     // the block's row of Blocks::neighbour
  const int* wall_slot;  // [block] place in raw, −1 away from walls
  const T* raw;          // [wall block][plane][own node][4]
  int planes;
  Index<Dim> first;
  GridConstants<T, Dim> constants;
  const T* force;  // Δt b of the body force, m/s: [block][own node][Dim], null where there is none

  /// The quad of own node `own` of a block; null where nothing is known.
  JAXMPM_FUNCTION const T* quad(int block, int own) const {
    if (block < 0 || wall_slot[block] < 0) return nullptr;
    return raw + std::size_t(wall_slot[block]) * std::size_t(planes * plane) + 4 * own;
  }
  JAXMPM_FUNCTION NodeSums<T, Dim> operator()(const Index<Dim>& node) const {
    NodeSums<T, Dim> sum{};
    const Place<Dim> at = locate<Dim>(around, first, node);
    const T* q = quad(at.block, at.own);
    if (!q) return sum;
    sum.mass = q[0];
    const Vector<T, Dim> pull = pull_at<T, Dim>(constants, force, at.block, at.own);
    for (int c = 0; c < Dim; ++c) {
      const T impulse = planes == 2 ? q[plane + 1 + c] : T(0);
      sum.momentum[c] = q[1 + c] + impulse + sum.mass * pull[c];
      sum.momentum[c] -= constants.damped * sum.momentum[c];
    }
    return sum;
  }
};

/// Where a node lies with regard to the domain. Stencils end one node (cubic: with weight zero two) beyond a face.
struct NodeStanding {
  bool inside = true;   // 0 … N along every axis: what happens elsewhere is an image and counts not
  bool reached = true;  // −1 … N + 1
};
template <class T, int Dim>
JAXMPM_FUNCTION NodeStanding standing(const Walls<T, Dim>& walls, const Index<Dim>& node) {
  NodeStanding at;
  for (int d = 0; d < Dim; ++d) {
    if (walls.periodic(d)) continue;
    const int i = node[std::size_t(d)], n = walls.cells[std::size_t(d)];
    at.inside = at.inside && i >= 0 && i <= n, at.reached = at.reached && i >= -1 && i <= n + 1;
  }
  return at;
}

/// Writes {m, v} (and the second plane's {–, Δv}) of own node `own` of a block at walls to `out`, the block's own nodes. `quad`: its raw
/// sums.
template <class T, int Dim>
JAXMPM_FUNCTION void write_wall_node(const T* quad, const Vector<T, Dim>& v, T mass_cut_off, int planes, int own, T* out) {
  constexpr int plane = BlockShape<Dim, 2>::cells * 4;
  const T mass = quad[0];
  out[4 * own] = mass;
  for (int c = 0; c < Dim; ++c) {
    out[4 * own + 1 + c] = v[c];
    if (planes == 2) out[plane + 4 * own + 1 + c] = mass > mass_cut_off ? v[c] - quad[1 + c] / mass : T(0);
  }
}

/// Applies an obstacle to the velocities of one node in place, where no wall is near. `quad`: {m, v}, `change`: a second plane's {–, Δv} or
/// null.
template <class T, int Dim>
JAXMPM_FUNCTION ObstacleContact<T, Dim> push_node(deck::ContactKind kind, T friction, const Vector<T, Dim>& normal, T mass_cut_off, T* quad,
                                                  T* change) {
  if (!(quad[0] > mass_cut_off)) return {};
  Vector<T, Dim> v{};
  for (int c = 0; c < Dim; ++c) v[c] = quad[1 + c];
  const ObstacleContact<T, Dim> done = apply_obstacle<T, Dim>(kind, friction, normal, quad[0], v);
  for (int c = 0; c < Dim; ++c) {
    if (change) change[1 + c] += v[c] - quad[1 + c];
    quad[1 + c] = v[c];
  }
  return done;
}

}  // namespace jaxmpm
