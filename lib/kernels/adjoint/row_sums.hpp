#pragma once
// Sums of a stencil's rows of nodes over the axes before the last, in 3D, with each factor or its derivative: what contract_3d() is made of.
#include "kernels/stencil_3d.hpp"

namespace jaxmpm {

/// Named by the factors along x and along y: w, d, g, and the derivatives dd = d' and gg = g'. Those with d or dd are there with moments,
/// those with gg and with g along both with slopes.
template <class T, int N>
struct RowSums {
  using R = Pack<T, N>;
  R ww = R(T(0)), gw = R(T(0)), wg = R(T(0));
  R dw = R(T(0)), wd = R(T(0)), ddw = R(T(0)), gd = R(T(0)), dg = R(T(0)), wdd = R(T(0));
  R gg_w = R(T(0)), g_g = R(T(0)), w_gg = R(T(0));
};

/// Of piece c of the rows, for the particle in lane l: along one axis after the other, so that nodes are weighed with few products.
template <int c, bool moments, bool slopes, class Sch, class Stencil>
JAXMPM_INLINE auto sum_rows(const StencilRows3d<Sch>& rows, const Stencil& t, int l) {
  using R = typename StencilRows3d<Sch>::R;
  using T = typename Sch::T;
  constexpr int S = Sch::S;
  RowSums<T, R::lanes> sum;
  for (int a = 0; a < S; ++a) {
    R by_w(T(0)), by_g(T(0)), by_d(T(0)), by_dd(T(0)), by_gg(T(0));
    for (int b = 0; b < S; ++b) {
      const R& node = rows.row[a * S + b][c];
      by_w += R(t.w[1][b][l]) * node, by_g += R(t.g[1][b][l]) * node;
      if constexpr (moments) by_d += R(t.d[1][b][l]) * node, by_dd += R(t.dd[1][b][l]) * node;
      if constexpr (slopes) by_gg += R(t.gg[1][b][l]) * node;
    }
    const R w(t.w[0][a][l]), g(t.g[0][a][l]);
    sum.ww += w * by_w, sum.gw += g * by_w, sum.wg += w * by_g;
    if constexpr (moments) {
      const R d(t.d[0][a][l]), dd(t.dd[0][a][l]);
      sum.dw += d * by_w, sum.wd += w * by_d, sum.ddw += dd * by_w, sum.gd += g * by_d, sum.dg += d * by_g, sum.wdd += w * by_dd;
    }
    if constexpr (slopes) sum.gg_w += R(t.gg[0][a][l]) * by_w, sum.g_g += g * by_g, sum.w_gg += w * by_gg;
  }
  return sum;
}

/// A particle's place along an axis, at t cells from the middle one of the three nodes that a quadratic spline reaches. With differences
/// n' = n_2 − n_0 and n'' = n_0 − 2 n_1 + n_2 of values at the nodes, Σ w n = n_1 + t/2 n' + (t²/2 + 1/8) n'', Σ g n = n'/2 + t n'' and
/// Σ g' n = n''; and the moments follow from the slopes: d = g/4 − (t³ − t/4)/2 g', d' = (3/8 − 3/2 t²) g'.
template <class T, int N>
struct QuadraticPlace {
  using R = Pack<T, N>;
  R t, half, square, cube, moment_slope;
  JAXMPM_INLINE explicit QuadraticPlace(T place)
      : t(place),
        half(T(0.5) * place),
        square(T(0.5) * place * place + T(0.125)),
        cube(T(0.5) * place * (place * place - T(0.25))),
        moment_slope(T(0.375) - T(1.5) * place * place) {}

  /// Σ w n, Σ g n and Σ g' n.
  struct Sums {
    R w, g, gg;
  };
  JAXMPM_INLINE Sums sum(const R& n0, const R& n1, const R& n2) const {
    const R first = n2 - n0, second = (n0 + n2) - R(T(2)) * n1;
    return {n1 + half * first + square * second, R(T(0.5)) * first + t * second, second};
  }
  /// Σ d n.
  JAXMPM_INLINE R moment(const R& g, const R& gg) const { return R(T(0.25)) * g - cube * gg; }
};

/// sum_rows() of quadratic splines, in two thirds of the operations.
template <int c, bool moments, class Sch, class Stencil>
JAXMPM_INLINE auto sum_quadratic_rows(const StencilRows3d<Sch>& rows, const Stencil& t, int l) {
  using R = typename StencilRows3d<Sch>::R;
  using T = typename Sch::T;
  static_assert(Sch::S == 3);
  const QuadraticPlace<T, R::lanes> x(T(-0.5) * t.g[0][1][l]), y(T(-0.5) * t.g[1][1][l]);
  typename QuadraticPlace<T, R::lanes>::Sums along_y[3];
  for (int a = 0; a < 3; ++a) along_y[a] = y.sum(rows.row[3 * a][c], rows.row[3 * a + 1][c], rows.row[3 * a + 2][c]);
  const auto w = x.sum(along_y[0].w, along_y[1].w, along_y[2].w), g = x.sum(along_y[0].g, along_y[1].g, along_y[2].g);
  const auto gg = x.sum(along_y[0].gg, along_y[1].gg, along_y[2].gg);
  RowSums<T, R::lanes> sum;
  sum.ww = w.w, sum.gw = w.g, sum.gg_w = w.gg, sum.wg = g.w, sum.g_g = g.g, sum.w_gg = gg.w;
  if constexpr (moments) {
    sum.dw = x.moment(w.g, w.gg), sum.ddw = x.moment_slope * w.gg, sum.wd = y.moment(g.w, gg.w), sum.wdd = y.moment_slope * gg.w;
    sum.gd = y.moment(g.g, gg.g), sum.dg = x.moment(g.g, g.gg);
  }
  return sum;
}

}  // namespace jaxmpm
