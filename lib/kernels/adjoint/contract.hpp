#pragma once
// What the adjoints of both transfers share: a transfer is f(X) = Σ_i [w_i A + Σ_k (d_k)_i B_k + Σ_k (g_k)_i C_k] · N_i with groups of V
// values, A, B_k, C_k of a particle and N_i of the nodes (particle to grid: the groups are the particle's and N the derivatives by the node;
// grid to particle: the other way round), so both need the same ∂f/∂X.
#include <initializer_list>
#include <type_traits>

#include "kernels/g2p.hpp"

namespace jaxmpm {

/// sums[j] += ∂f/∂X_j of one particle (lane l), one pack per axis: still to be added over its lanes. `rest`, `moments`, `slopes`: the
/// particle's groups A, B_0 and C_0, −1 where there are none. Where f depends on an axis only through its own factor, that factor is
/// replaced by its derivative: w by g, d by d', g by g'. `gathered`, where it is not null, receives what gather() finds in the same nodes.
template <class Sch, int rest, int moments, int slopes, class Stencil, class Rows, class Sums>
JAXMPM_INLINE void contract(const Rows& rows, const Stencil& t, int l, const typename Sch::T* groups, typename Rows::R* sums,
                            Sums gathered) {
  using T = typename Sch::T;
  using Row = typename Rows::Row;
  constexpr int S = Sch::S, N = Row::N, V = Sch::V, last = Sch::Dim - 1;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    const auto gather_from = [&](const R& w_sum, std::initializer_list<R> d_sums, std::initializer_list<R> g_sums) {
      if constexpr (!std::is_null_pointer_v<Sums>)
        gather_last_axis<Sch, c, (moments >= 0), (slopes >= 0), Stencil>(z, w_sum, d_sums.begin(), g_sums.begin(), gathered);
    };
    const R w = spread<V, Stencil::w_quad, c, N>(z), g = spread<V, Stencil::g_quad, c, N>(z);
    R line(T(0)), line_by_z(T(0));  // what goes with w on all axes but the last, and its derivative by the last
    if constexpr (rest >= 0) {
      const R A = repeat<V, rest, N>(groups);
      line = w * A, line_by_z = g * A;
    }
    if constexpr (moments >= 0) {
      const R B = repeat<V, moments + last, N>(groups);
      line += spread<V, Stencil::d_quad, c, N>(z) * B, line_by_z += spread<V, Stencil::dd_quad, c, N>(z) * B;
    }
    if constexpr (slopes >= 0) {
      const R C = repeat<V, slopes + last, N>(groups);
      line += g * C, line_by_z += spread<V, Stencil::gg_quad, c, N>(z) * C;
    }
    R moment[2], moment_by_z[2], slope[2], slope_by_z[2];  // what goes with d or g on one of the other axes
    static_for<Sch::Dim - 1>([&](auto axis) JAXMPM_INLINE_LAMBDA {
      constexpr int k = axis;
      if constexpr (moments >= 0) {
        const R B = repeat<V, moments + k, N>(groups);
        moment[k] = w * B, moment_by_z[k] = g * B;
      }
      if constexpr (slopes >= 0) {
        const R C = repeat<V, slopes + k, N>(groups);
        slope[k] = w * C, slope_by_z[k] = g * C;
      }
    });
    // The nodes are summed over the axes before the last first, with each factor or its derivative: fewer products than to weigh each node.
    if constexpr (Sch::Dim == 2) {
      R by_w(T(0)), by_g(T(0)), by_d(T(0)), by_dd(T(0)), by_gg(T(0));
      for (int a = 0; a < S; ++a) {
        const R& node = rows.row[a][c];
        by_w += R(t.w[0][a][l]) * node, by_g += R(t.g[0][a][l]) * node;
        if constexpr (moments >= 0) by_d += R(t.d[0][a][l]) * node, by_dd += R(t.dd[0][a][l]) * node;
        if constexpr (slopes >= 0) by_gg += R(t.gg[0][a][l]) * node;
      }
      gather_from(by_w, {by_d}, {by_g});
      sums[0] += by_g * line, sums[1] += by_w * line_by_z;
      if constexpr (moments >= 0) sums[0] += by_dd * moment[0], sums[1] += by_d * moment_by_z[0];
      if constexpr (slopes >= 0) sums[0] += by_gg * slope[0], sums[1] += by_g * slope_by_z[0];
    } else {
      R ww(T(0)), gw(T(0)), wg(T(0));                                  // factors along x and along y
      R dw(T(0)), wd(T(0)), ddw(T(0)), gd(T(0)), dg(T(0)), wdd(T(0));  // with moments
      R gg_w(T(0)), g_g(T(0)), w_gg(T(0));                             // with slopes: g', and g along both
      for (int a = 0; a < S; ++a) {
        R by_w(T(0)), by_g(T(0)), by_d(T(0)), by_dd(T(0)), by_gg(T(0));
        for (int b = 0; b < S; ++b) {
          const R& node = rows.row[a * S + b][c];
          by_w += R(t.w[1][b][l]) * node, by_g += R(t.g[1][b][l]) * node;
          if constexpr (moments >= 0) by_d += R(t.d[1][b][l]) * node, by_dd += R(t.dd[1][b][l]) * node;
          if constexpr (slopes >= 0) by_gg += R(t.gg[1][b][l]) * node;
        }
        const R w_x(t.w[0][a][l]), g_x(t.g[0][a][l]);
        ww += w_x * by_w, gw += g_x * by_w, wg += w_x * by_g;
        if constexpr (moments >= 0) {
          const R d_x(t.d[0][a][l]), dd_x(t.dd[0][a][l]);
          dw += d_x * by_w, wd += w_x * by_d, ddw += dd_x * by_w, gd += g_x * by_d, dg += d_x * by_g, wdd += w_x * by_dd;
        }
        if constexpr (slopes >= 0) gg_w += R(t.gg[0][a][l]) * by_w, g_g += g_x * by_g, w_gg += w_x * by_gg;
      }
      gather_from(ww, {dw, wd}, {gw, wg});
      sums[0] += gw * line, sums[1] += wg * line, sums[2] += ww * line_by_z;
      if constexpr (moments >= 0) {
        sums[0] += ddw * moment[0], sums[1] += dg * moment[0], sums[2] += dw * moment_by_z[0];
        sums[0] += gd * moment[1], sums[1] += wdd * moment[1], sums[2] += wd * moment_by_z[1];
      }
      if constexpr (slopes >= 0) {
        sums[0] += gg_w * slope[0], sums[1] += g_g * slope[0], sums[2] += gw * slope_by_z[0];
        sums[0] += g_g * slope[1], sums[1] += w_gg * slope[1], sums[2] += wg * slope_by_z[1];
      }
    }
  });
}

/// The same for f(X) = Σ_i w_i m m̄_i with masses that are kept apart. `gathered` becomes Σ_i w_i m̄_i, half of its lanes.
template <class Sch, class Stencil>
JAXMPM_INLINE void contract_mass(const StencilRows<Sch, true>& rows, const Stencil& t, int l, typename Sch::T m,
                                 typename StencilRows<Sch, true>::R* sums, typename StencilRows<Sch, true>::R& gathered) {
  using T = typename Sch::T;
  using M = typename StencilRows<Sch, true>::M;
  const T* z = t.last.row(l);
  M sum(T(0)), by_x(T(0)), by_y(T(0));
  for (int c = 0; c < StencilRows<Sch, true>::Row::pieces; ++c) {
    const M w = M::load(z + 4 * Stencil::w_quad + c * M::lanes), g = M::load(z + 4 * Stencil::g_quad + c * M::lanes);
    M by_w(T(0)), by_g(T(0));
    for (int a = 0; a < Sch::S; ++a) by_w += M(t.w[0][a][l]) * rows.mass[a][c], by_g += M(t.g[0][a][l]) * rows.mass[a][c];
    sum += by_w * w, by_x += by_g * w, by_y += by_w * g;
  }
  const M nothing(T(0));
  gathered = join(sum, nothing);
  sums[0] += join(M(m) * by_x, nothing), sums[1] += join(M(m) * by_y, nothing);
}

}  // namespace jaxmpm
