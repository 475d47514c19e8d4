#pragma once
// Stencils in 3D, where lanes are the nodes of a row (along the last axis), four values each: the nodes are summed over the other axes with
// factors of one particle in all lanes, and only those along the last axis are laid out by node.
#include "kernels/batch.hpp"
#include "kernels/scheme.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Base nodes of W particles in their block's arena and the factors of each axis. `Derived`: with the derivatives of the factors by the
/// particle's place: w' = g, d' = (w (X_i − X_p))' = g (X_i − X_p) − w and g'.
template <class Sch, bool Moments, bool Slopes, bool Derived>
struct Stencils3d {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  static constexpr bool with_g = Slopes || Derived, with_dd = Moments && Derived, with_gg = Slopes && Derived;
  /// Quads of a row along the last axis: w, then d, then g, d' and g'.
  static constexpr int w_quad = 0, d_quad = 1, g_quad = Moments ? 2 : 1, dd_quad = g_quad + int(with_g), gg_quad = dd_quad + int(with_dd);
  static constexpr int quads = gg_quad + int(with_gg);

  alignas(64) int base[W];
  alignas(64) T w[Dim - 1][S][W], d[Dim - 1][S][W], g[Dim - 1][S][W];  // axes but the last, to be broadcast
  alignas(64) T dd[with_dd ? Dim - 1 : 1][S][W], gg[with_gg ? Dim - 1 : 1][S][W];
  ParticleRows<T, 4 * quads> last;  // the last axis, to be spread

  JAXMPM_INLINE Stencils3d(const Particles<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin) {
    constexpr int A = Sch::Shape::A;
    Pack<int, W> node(0);
    for (int axis = 0; axis < Dim; ++axis) {
      const auto X = load_places<W>(p.position[std::size_t(axis)].data() + s, count);
      const auto first = make_places<W>([&](std::size_t k) { return floor(X[k] - Bspline<S>::base_shift); });
      node = node * Pack<int, W>(A) + (from_places<int, W>(first) - Pack<int, W>(origin[std::size_t(axis)]));
      const P f = from_places<T, W>(make_places<W>([&](std::size_t k) { return X[k] - first[k]; }));
      P weight[S], slope[S], curvature[S];
      Bspline<S>::weights(f, weight);
      if constexpr (with_g) Bspline<S>::slopes(f, slope);
      if constexpr (with_gg) Bspline<S>::curvatures(f, curvature);
      if (axis < Dim - 1) {
        for (int a = 0; a < S; ++a) {
          weight[a].store(w[axis][a]);
          if constexpr (Moments) (weight[a] * (P(T(a)) - f)).store(d[axis][a]);
          if constexpr (with_g) slope[a].store(g[axis][a]);
          if constexpr (with_dd) (slope[a] * (P(T(a)) - f) - weight[a]).store(dd[axis][a]);
          if constexpr (with_gg) curvature[a].store(gg[axis][a]);
        }
      } else {
        P row[decltype(last)::stride];
        for (P& r : row) r = P(T(0));
        for (int a = 0; a < S; ++a) {
          row[4 * w_quad + a] = weight[a];
          if constexpr (Moments) row[4 * d_quad + a] = weight[a] * (P(T(a)) - f);
          if constexpr (with_g) row[4 * g_quad + a] = slope[a];
          if constexpr (with_dd) row[4 * dd_quad + a] = slope[a] * (P(T(a)) - f) - weight[a];
          if constexpr (with_gg) row[4 * gg_quad + a] = curvature[a];
        }
        last.fill(row);
      }
    }
    node.store(base);
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
