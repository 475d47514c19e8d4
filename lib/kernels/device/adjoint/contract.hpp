#pragma once
// What the adjoints of both transfers share on a device: f(X) = Σ_i [w_i A + Σ_k (d_k)_i B_k + Σ_k (g_k)_i C_k] · N_i by a particle's
// position (kernels/adjoint/contract.hpp), and where all teams add up derivatives by constants.
#include "kernels/adjoint/material_adjoint.hpp"
#include "kernels/device/shares.hpp"

namespace jaxmpm {

/// Σ over the nodes of a stencil of value × share. The factors of the share at the nodes are those of `s`; the values stand at every
/// fourth place from the stencil's first node.
template <bool with_d, bool with_g, int axis = 0, class Sch, class T, int Dim>
JAXMPM_INLINE T contract(const Factors<Sch>& s, const Share<T, Dim>& q, const T* values) {
  T sum(0);
  JAXMPM_UNROLL
  for (int a = 0; a < Sch::S; ++a) {
    const T* at = values + 4 * StencilNodes<Sch>::step(axis) * a;
    if constexpr (axis < Dim - 1) {
      sum += contract<with_d, with_g, axis + 1>(s, along<axis, with_d, with_g>(s, a, q), at);
    } else {
      T given = s.w[axis][a] * q.plain;
      if constexpr (with_d) given += s.d[axis][a] * q.d[axis];
      if constexpr (with_g) given += s.g[axis][a] * q.g[axis];
      sum += given * *at;
    }
  }
  return sum;
}

/// Derivatives by constants, added up by all teams in a table of doubles: by the model's, then of each body by its law's constants, with
/// its count of kinks.
struct ConstantBars {
  static constexpr int gravity = 0, damping = 3, flip_fraction = 4, wall_velocity = 5, segment = wall_velocity + 18;
  static constexpr int of_body = MaterialReport::most_constants + 1, kinks = MaterialReport::most_constants;
  int segments, obstacles;
  int obstacle() const { return segment + segments; }
  int body(std::size_t b) const { return obstacle() + obstacles + of_body * int(b); }
};

/// One thread's share of a body's.
template <class Law>
struct MaterialBars {
  static constexpr int count = int(std::tuple_size_v<decltype(Law::constants(std::declval<Law&>()))>);
  static_assert(count <= MaterialReport::most_constants && Law::by_hand, "a device has no tape");
  double by_constants[count] = {}, kinks = 0;

  template <class T>
  JAXMPM_INLINE void add(const T (&by)[count]) {
    for (int k = 0; k < count; ++k) by_constants[k] += double(by[k]);
  }
  /// Adds those of all threads to the body's place in the table.
  template <class Team>
  JAXMPM_INLINE void give(const Team& team, double* body) const {
    for (int k = 0; k < count; ++k) give_sum(team, by_constants[k], body + k);
    give_sum(team, kinks, body + ConstantBars::kinks);
  }
  template <class Team>
  static JAXMPM_INLINE void give_sum(const Team& team, double mine, double* to) {
    const double sum = team_sum(team, mine);
    if (team.team_rank() == 0 && sum != 0) Kokkos::atomic_add(to, sum);
  }
};

}  // namespace jaxmpm
