#pragma once
// The stencil of one particle, and what a team shares: its tile and its arena.
#include "core/parallel.hpp"
#include "kernels/device/particles.hpp"
#include "kernels/p2g.hpp"
#include "kernels/wall_node.hpp"

namespace jaxmpm {

/// Threads of a team in the grid update (one a node), and teams that a processor shall have room for.
inline constexpr int grid_threads = 64, grid_resident = 16;

/// A node's record, which a device loads and stores at once.
template <class T>
struct alignas(16) Quad {
  T a[4];
};
/// Record `node` of an array of records; the array begins at a multiple of 16 bytes.
template <class T>
JAXMPM_INLINE Quad<T>& quad_at(T* records, int node) {
  return *reinterpret_cast<Quad<T>*>(records + 4 * node);
}
template <class T>
JAXMPM_INLINE const Quad<T>& quad_at(const T* records, int node) {
  return *reinterpret_cast<const Quad<T>*>(records + 4 * node);
}

/// The nodes of a stencil in an arena, in the order of their indices.
template <class Sch>
struct StencilNodes {
  static constexpr int S = Sch::S, Dim = Sch::Dim;
  static constexpr int count(int axes) { return axes == 0 ? 1 : S * count(axes - 1); }
  static constexpr int all = count(Dim), rows = all / S;
  /// From one node to the next along an axis.
  static constexpr int step(int axis) { return axis == Dim - 1 ? 1 : Sch::Shape::A * step(axis + 1); }
  /// Node n from the stencil's first.
  static constexpr int at(int n) {
    return Dim == 2 ? Sch::Shape::arena_node(n / S, n % S, 0) : Sch::Shape::arena_node(n / (S * S), n / S % S, n % S);
  }
};

/// Factors of a particle along each axis (kernels/scheme.hpp): weight w, moment d = w (X_i − X_p) and slope g = dφ/dX of its nodes, from
/// its offset behind the base node.
template <class Sch>
struct Factors {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S;
  T w[Dim][S], d[Dim][S], g[Dim][S];

  explicit JAXMPM_INLINE Factors(const T (&offset)[Dim]) {
    JAXMPM_UNROLL
    for (int axis = 0; axis < Dim; ++axis) {
      Bspline<S>::weights(offset[axis], w[axis]);
      Bspline<S>::slopes(offset[axis], g[axis]);
      JAXMPM_UNROLL
      for (int a = 0; a < S; ++a) d[axis][a] = w[axis][a] * (T(a) - offset[axis]);
    }
  }

  /// Products over the axes but the last, for a row of nodes along that: w of all of them, and with d or g on axis k.
  struct Row {
    T w, d[Dim - 1], g[Dim - 1];
  };
  JAXMPM_INLINE Row row(int r) const {
    if constexpr (Dim == 2) {
      return {w[0][r], {d[0][r]}, {g[0][r]}};
    } else {
      const int a = r / S, b = r % S;
      return {w[0][a] * w[1][b], {d[0][a] * w[1][b], w[0][a] * d[1][b]}, {g[0][a] * w[1][b], w[0][a] * g[1][b]}};
    }
  }
};

/// A particle's position, cells.
template <int Dim>
struct Position {
  double X[Dim] = {};

  Position() = default;
  template <class T>
  JAXMPM_INLINE Position(const ParticleFields<T, Dim>& particles, std::size_t p) {
    for (int axis = 0; axis < Dim; ++axis) X[axis] = particles.position(axis, p);
  }
};

/// Where a particle stands: its base node in the arena that begins at `origin`, and its offset behind that, in cells.
template <class Sch>
struct Cell {
  int base = 0;
  typename Sch::T offset[Sch::Dim];

  JAXMPM_INLINE Cell(const Position<Sch::Dim>& at, const Index<Sch::Dim>& origin) {
    for (int axis = 0; axis < Sch::Dim; ++axis) {
      const double b = std::floor(at.X[axis] - Bspline<Sch::S>::base_shift);
      base = base * Sch::Shape::A + (int(b) - origin[std::size_t(axis)]);
      offset[axis] = typename Sch::T(at.X[axis] - b);
    }
  }
};

/// Copies the nodes around a block, whose row of Blocks::neighbour is `around`, from those of all blocks ([block][own]) into a tile's
/// arena, which begins one node below the block.
template <class Sch, class Team>
JAXMPM_INLINE void load_arena(const Team& team, const int* around, const typename Sch::T* nodes, typename Sch::T* arena) {
  constexpr int A = Sch::Shape::A, Dim = Sch::Dim;
  team_for(team, Sch::Shape::arena_nodes, [&](int i) {
    Index<Dim> node{};
    for (int d = Dim - 1, rest = i; d >= 0; --d, rest /= A) node[std::size_t(d)] = rest % A - 1;
    const Place<Dim> at = locate<Dim>(around, Index<Dim>{}, node);
    for (int plane = 0; plane < Sch::planes; ++plane)
      quad_at(arena + plane * Sch::arena_plane, i) =
          quad_at(nodes + std::size_t(at.block) * Sch::own_size + plane * Sch::own_plane, at.own);
  });
}

/// The tiles of one body, in a device's memory.
template <class T, int Dim>
struct TileTable {
  const Tile* tiles;         // [tile] of this body
  const Index<Dim>* blocks;  // [block] Blocks::index
  T* arenas;                 // [tile] of this body

  /// Node 0 of a tile's arena.
  JAXMPM_INLINE Index<Dim> origin(const Tile& tile) const {
    Index<Dim> node = first_node<Dim>(blocks[tile.block]);
    for (int d = 0; d < Dim; ++d) node[std::size_t(d)] -= 1;
    return node;
  }
};

}  // namespace jaxmpm
