#pragma once
// The stencil of one particle, one thread's work, and what a team shares: its tile and its arena.
#include "core/parallel.hpp"
#include "kernels/device/particles.hpp"
#include "kernels/p2g.hpp"
#include "kernels/wall_node.hpp"

namespace jaxmpm {

/// Threads of a team in the transfers and in the grid update (one a node).
inline constexpr int transfer_threads = 128, grid_threads = 64;

/// Factors of a particle along each axis (kernels/scheme.hpp): weight w, moment d = w (X_i − X_p), slope g = dφ/dX; and its base node.
template <class Sch>
struct Stencil {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S;
  T w[Dim][S], d[Dim][S], g[Dim][S];
  int base = 0;  // in the arena

  JAXMPM_INLINE Stencil(const ParticleFields<T, Dim>& particles, std::size_t p, const Index<Dim>& origin) {
    for (int axis = 0; axis < Dim; ++axis) {
      const double X = particles.position(axis, p), b = std::floor(X - Bspline<S>::base_shift);
      const T f = T(X - b);
      base = base * Sch::Shape::A + (int(b) - origin[std::size_t(axis)]);
      Bspline<S>::weights(f, w[axis]);
      Bspline<S>::slopes(f, g[axis]);
      for (int a = 0; a < S; ++a) d[axis][a] = w[axis][a] * (T(a) - f);
    }
  }

  /// Products over the axes but the last: w of all of them, and with d or g on axis k.
  struct Row {
    T w, d[Dim - 1], g[Dim - 1];
    int node;  // the row's first, from the base
  };
  JAXMPM_INLINE Row row(int r) const {
    Row row;
    if constexpr (Dim == 2) {
      row = {w[0][r], {d[0][r]}, {g[0][r]}, Sch::Shape::arena_node(r, 0, 0)};
    } else {
      const int a = r / S, b = r % S;
      row = {w[0][a] * w[1][b],
             {d[0][a] * w[1][b], w[0][a] * d[1][b]},
             {g[0][a] * w[1][b], w[0][a] * g[1][b]},
             Sch::Shape::arena_node(a, b, 0)};
    }
    return row;
  }
  static constexpr int rows = Dim == 2 ? S : S * S;
};

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

/// The particle (from the tile's first) that a thread takes when its team works on `threads` of them from `first`: neighbours in storage
/// mostly share a cell, so a warp takes them eight apart, or its threads would all add to the same nodes.
JAXMPM_INLINE int spread_particle(int first, int thread, int threads) {
  const int apart = threads % 8 == 0 ? 8 : 1;
  return first + thread % (threads / apart) * apart + thread / (threads / apart);
}

}  // namespace jaxmpm
