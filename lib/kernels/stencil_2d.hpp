#pragma once
// Stencils in 2D, where lanes are particles throughout: the rows of nodes around W particles are turned into packs of one value of one node
// each (gather_2d.hpp), and what they give into rows (scatter_2d.hpp). That takes fewer moves across lanes than to lay out a particle's factors by node, as 3D does with its many nodes.
#include "core/tensor.hpp"
#include "kernels/batch.hpp"
#include "kernels/scheme.hpp"
#include "state/particle_view.hpp"

namespace jaxmpm {

/// Base nodes of W particles in their block's arena and the factors of each axis. `Derived`: with the derivatives of the factors by the
/// particle's place: w' = g, d' = (w (X_i − X_p))' = g (X_i − X_p) − w and g'.
template <class Sch, bool Moments, bool Slopes, bool Derived>
struct Stencils2d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  enum Kind { w, d, g, dd, gg, kinds };
  static constexpr bool with_g = Slopes || Derived, with_dd = Moments && Derived, with_gg = Slopes && Derived;

  /// Where row a of a stencil begins behind its base node.
  static constexpr int row(int a) { return Sch::Shape::arena_node(a, 0, 0); }

  alignas(64) int base[W];
  P factor[2][kinds][S];             // [axis][kind][node]
  alignas(64) T first[g + 1][S][W];  // w, d and g of the first axis, to be broadcast

  JAXMPM_INLINE Stencils2d(const ParticleView<T, 2>& p, std::size_t s, int count, const Index<2>& origin) {
    Pack<int, W> node(0);
    for (int axis = 0; axis < 2; ++axis) {
      const auto X = load_places<W>(p.position[std::size_t(axis)].data() + s, count);
      const auto first = make_places<W>([&](std::size_t k) { return floor(X[k] - Bspline<S>::base_shift); });
      node = node * Pack<int, W>(Sch::Shape::A) + (from_places<int, W>(first) - Pack<int, W>(origin[std::size_t(axis)]));
      const P f = from_places<T, W>(make_places<W>([&](std::size_t k) { return X[k] - first[k]; }));
      P(&of)[kinds][S] = factor[axis];
      Bspline<S>::weights(f, of[w]);
      if constexpr (with_g) Bspline<S>::slopes(f, of[g]);
      if constexpr (with_gg) Bspline<S>::curvatures(f, of[gg]);
      for (int a = 0; a < S; ++a) {
        const P distance = P(T(a)) - f;
        if constexpr (Moments) of[d][a] = of[w][a] * distance;
        if constexpr (with_dd) of[dd][a] = of[g][a] * distance - of[w][a];
      }
    }
    for (int a = 0; a < S; ++a) {
      factor[0][w][a].store(first[w][a]);
      if constexpr (Moments) factor[0][d][a].store(first[d][a]);
      if constexpr (Slopes) factor[0][g][a].store(first[g][a]);
    }
    node.store(base);
  }
};

/// A row of S nodes along the last axis in packs: `lanes` values, `each` of every node, in pieces of N.
template <class T, int S, int each>
struct NodeRow {
  static constexpr int lanes = each * (S == 2 ? 2 : 4);
  static constexpr int N = native_lanes<T> < lanes ? native_lanes<T> : lanes, pieces = lanes / N;
};

}  // namespace jaxmpm
