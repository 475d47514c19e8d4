#pragma once
// What the adjoints of both transfers share: a transfer is f(X) = Σ_i [w_i A + Σ_k (d_k)_i B_k + Σ_k (g_k)_i C_k] · N_i with a particle's
// quads A, B_k, C_k and the nodes' quads N_i (particle to grid: the quads are the particle's and N the derivatives by the node; grid to
// particle: the other way round), so both need the same ∂f/∂X.
#include "kernels/g2p.hpp"

namespace jaxmpm {

/// sums[j] += ∂f/∂X_j of one particle (lane l), one pack per axis: still to be added over its lanes. `rest`, `moments`, `slopes`: the
/// particle's quads A, B_0 and C_0, −1 where there are none. Where f depends on an axis only through its own factor, that factor is
/// replaced by its derivative: w by g, d by d', g by g'.
template <class Sch, int rest, int moments, int slopes, class Stencil>
JAXMPM_INLINE void contract(const StencilRows<Sch>& rows, const Stencil& t, int l, const typename Sch::T* quads,
                            Pack<typename Sch::T, RowShape<typename Sch::T, Sch::S>::N>* sums) {
  using T = typename Sch::T;
  using Row = RowShape<T, Sch::S>;
  constexpr int S = Sch::S, N = Row::N, last = Sch::Dim - 1;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) {
    constexpr int c = piece;
    const R w = spread_quad<Stencil::w_quad, c, N>(z), g = spread_quad<Stencil::g_quad, c, N>(z);
    R line(T(0)), line_by_z(T(0));  // what goes with w on all axes but the last, and its derivative by the last
    if constexpr (rest >= 0) {
      const R A = repeat_quad<rest, N>(quads);
      line = w * A, line_by_z = g * A;
    }
    if constexpr (moments >= 0) {
      const R B = repeat_quad<moments + last, N>(quads);
      line += spread_quad<Stencil::d_quad, c, N>(z) * B, line_by_z += spread_quad<Stencil::dd_quad, c, N>(z) * B;
    }
    if constexpr (slopes >= 0) {
      const R C = repeat_quad<slopes + last, N>(quads);
      line += g * C, line_by_z += spread_quad<Stencil::gg_quad, c, N>(z) * C;
    }
    R moment[2], moment_by_z[2], slope[2], slope_by_z[2];  // what goes with d or g on one of the other axes
    static_for<Sch::Dim - 1>([&](auto axis) {
      constexpr int k = axis;
      if constexpr (moments >= 0) {
        const R B = repeat_quad<moments + k, N>(quads);
        moment[k] = w * B, moment_by_z[k] = g * B;
      }
      if constexpr (slopes >= 0) {
        const R C = repeat_quad<slopes + k, N>(quads);
        slope[k] = w * C, slope_by_z[k] = g * C;
      }
    });
    const auto along = [&](int k, int a, const R* m, const R* s) {  // d B_k + g C_k at node a of axis k
      R r(T(0));
      if constexpr (moments >= 0) r = R(t.d[k][a][l]) * m[k];
      if constexpr (slopes >= 0) r += R(t.g[k][a][l]) * s[k];
      return r;
    };
    const auto along_derived = [&](int k, int a) {  // its derivative by axis k
      R r(T(0));
      if constexpr (moments >= 0) r = R(t.dd[k][a][l]) * moment[k];
      if constexpr (slopes >= 0) r += R(t.gg[k][a][l]) * slope[k];
      return r;
    };
    if constexpr (Sch::Dim == 2) {
      for (int a = 0; a < S; ++a) {
        const R& node = rows.row[a][c];
        sums[0] += node * (R(t.g[0][a][l]) * line + along_derived(0, a));
        sums[1] += node * (R(t.w[0][a][l]) * line_by_z + along(0, a, moment_by_z, slope_by_z));
      }
    } else {
      R y[S], y_by_y[S], y_by_z[S];
      for (int b = 0; b < S; ++b)
        y[b] = along(1, b, moment, slope), y_by_y[b] = along_derived(1, b), y_by_z[b] = along(1, b, moment_by_z, slope_by_z);
      for (int a = 0; a < S; ++a) {
        const R wx(t.w[0][a][l]), gx(t.g[0][a][l]);
        const R plane = wx * line + along(0, a, moment, slope), plane_by_x = gx * line + along_derived(0, a);
        const R plane_by_z = wx * line_by_z + along(0, a, moment_by_z, slope_by_z);
        for (int b = 0; b < S; ++b) {
          const R& node = rows.row[a * S + b][c];
          const R wy(t.w[1][b][l]);
          sums[0] += node * (wy * plane_by_x + gx * y[b]);
          sums[1] += node * (R(t.g[1][b][l]) * plane + wx * y_by_y[b]);
          sums[2] += node * (wy * plane_by_z + wx * y_by_z[b]);
        }
      }
    }
  });
}

}  // namespace jaxmpm
