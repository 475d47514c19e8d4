#pragma once
// Adjoint of the grid update where no wall is near.
#include "kernels/grid.hpp"

namespace jaxmpm {

/// Adjoint of update_node: `bar` and `by_change` hold derivatives by {–, v} (and {–, Δv} of a second quad) and receive those by the sums
/// {m, p} (and {–, impulse}); `sums` and `impulse` are what the forward update found there. Returns the derivatives by Δt g.
template <class Sch>
JAXMPM_INLINE Vector<typename Sch::T, Sch::Dim> update_node_adjoint(const typename Sch::T* sums, const typename Sch::T* impulse,
                                                                    const GridConstants<typename Sch::T, Sch::Dim>& grid,
                                                                    typename Sch::T* bar, typename Sch::T* by_change) {
  using T = typename Sch::T;
  Vector<T, Sch::Dim> by_pull{};
  if (!(sums[0] > grid.mass_cut_off)) {
    for (int c = 0; c < 4; ++c) bar[c] = by_change[c] = T(0);
    return by_pull;
  }
  const T inverse = T(1) / sums[0];
  T by_inverse(0);
  for (int c = 1; c <= Sch::Dim; ++c) {
    T by_undamped = bar[c] - grid.damped * bar[c];
    if constexpr (Sch::planes == 2) by_undamped -= grid.damped * by_change[c];
    by_pull[c - 1] = by_undamped;
    by_inverse += by_undamped * sums[c];
    if constexpr (Sch::planes == 2) {
      by_pull[c - 1] += by_change[c];  // Δv = impulse/m + Δt g enters v as well
      by_inverse += by_pull[c - 1] * impulse[c];
      by_change[c] = by_pull[c - 1] * inverse;
    }
    bar[c] = by_undamped * inverse;
  }
  if constexpr (Sch::dilation) {
    constexpr int lane = Sch::dilation_lane;
    T& by_mean = (Sch::dilation_plane == 0 ? bar : by_change)[lane];
    by_inverse += by_mean * (Sch::dilation_plane == 0 ? sums : impulse)[lane];
    by_mean *= inverse;
  }
  bar[0] = -by_inverse * inverse * inverse;
  return by_pull;
}

/// The same for the nodes of a block; `raw`: its sums, `own`: derivatives, in place.
template <class Sch>
Vector<typename Sch::T, Sch::Dim> update_nodes_adjoint(const typename Sch::T* raw, const GridConstants<typename Sch::T, Sch::Dim>& grid,
                                                       typename Sch::T* own) {
  constexpr int change = (Sch::planes - 1) * Sch::own_plane;
  Vector<typename Sch::T, Sch::Dim> by_pull{};
  for (int node = 0; node < Sch::Shape::cells; ++node) {
    const auto by = update_node_adjoint<Sch>(raw + 4 * node, raw + change + 4 * node, grid, own + 4 * node, own + change + 4 * node);
    for (int c = 0; c < Sch::Dim; ++c) by_pull[c] += by[c];
  }
  return by_pull;
}

}  // namespace jaxmpm
