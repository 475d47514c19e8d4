#pragma once
// Stencils in 3D, where lanes are the nodes of a row (along the last axis), four values each: the nodes are summed over the other axes with
// factors of one particle in all lanes, and only those along the last axis are laid out by node.
#include "kernels/batch.hpp"
#include "kernels/scheme.hpp"
#include "state/particle_view.hpp"

namespace jaxmpm {

/// Base nodes of W particles in their block's arena, and how far from there they are on each axis, cells.
template <class Sch>
struct StencilPlaces3d {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, W = batch<T>;
  alignas(64) int base[W];
  Pack<T, W> offset[Dim];

  JAXMPM_INLINE StencilPlaces3d(const ParticleView<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin) {
    Pack<int, W> node(0);
    for (int axis = 0; axis < Dim; ++axis) {
      const auto X = load_places<W>(p.position[std::size_t(axis)].data() + s, count);
      const auto first = make_places<W>([&](std::size_t k) { return floor(X[k] - Bspline<Sch::S>::base_shift); });
      node = node * Pack<int, W>(Sch::Shape::A) + (from_places<int, W>(first) - Pack<int, W>(origin[std::size_t(axis)]));
      offset[axis] = from_places<T, W>(make_places<W>([&](std::size_t k) { return X[k] - first[k]; }));
    }
    node.store(base);
  }
};

/// With the factors of each axis.
template <class Sch, bool Moments, bool Slopes>
struct Stencils3d : StencilPlaces3d<Sch> {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  /// Quads of a row along the last axis: w, then d, then g.
  static constexpr int w_quad = 0, d_quad = 1, g_quad = Moments ? 2 : 1, quads = g_quad + int(Slopes);

  alignas(64) T w[Dim - 1][S][W], d[Dim - 1][S][W], g[Dim - 1][S][W];  // axes but the last, to be broadcast
  ParticleRows<T, 4 * quads> last;                                     // the last axis, to be spread

  JAXMPM_INLINE Stencils3d(const ParticleView<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin)
      : StencilPlaces3d<Sch>(p, s, count, origin) {
    for (int axis = 0; axis < Dim; ++axis) {
      const P f = this->offset[axis];
      P weight[S], slope[S];
      Bspline<S>::weights(f, weight);
      if constexpr (Slopes) Bspline<S>::slopes(f, slope);
      if (axis < Dim - 1) {
        for (int a = 0; a < S; ++a) {
          weight[a].store(w[axis][a]);
          if constexpr (Moments) (weight[a] * (P(T(a)) - f)).store(d[axis][a]);
          if constexpr (Slopes) slope[a].store(g[axis][a]);
        }
      } else {
        P row[decltype(last)::stride];
        for (P& r : row) r = P(T(0));
        for (int a = 0; a < S; ++a) {
          row[4 * w_quad + a] = weight[a];
          if constexpr (Moments) row[4 * d_quad + a] = weight[a] * (P(T(a)) - f);
          if constexpr (Slopes) row[4 * g_quad + a] = slope[a];
        }
        last.fill(row);
      }
    }
  }
};

/// Lanes of one piece of a row of S quads, and pieces per row.
template <class T, int S>
struct QuadRow {
  static constexpr int wanted = S == 2 ? 8 : 16;
  static constexpr int N = native_lanes<T> < wanted ? native_lanes<T> : wanted;
  static constexpr int pieces = pieces_of(4 * S, N);
};

/// Values of one plane at the nodes of a stencil, kept in registers while consecutive particles share a base node: rows[a·S + b], each of
/// `pieces` packs.
template <class Sch>
struct StencilRows3d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, count = S * S;
  using Row = QuadRow<T, S>;
  using R = Pack<T, Row::N>;
  R row[count][Row::pieces];

  static constexpr int place(int r) { return Sch::Shape::arena_node(r / S, r % S, 0) * 4; }
  JAXMPM_INLINE void clear() {
    for (auto& r : row)
      for (R& piece : r) piece = R(T(0));
  }
  JAXMPM_INLINE void add_to(T* base) const {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) {
        T* at = base + place(r) + c * Row::N;
        (R::load(at) + row[r][c]).store(at);
      }
  }
  JAXMPM_INLINE void load(const T* base) {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) row[r][c] = R::load(base + place(r) + c * Row::N);
  }
};

}  // namespace jaxmpm
