#pragma once
// Particles to grid (Eqs 10–12, B.1, B.2): one tile scatters mass, momentum and impulse of the internal force to its arena.
#include "kernels/material_kernel.hpp"
#include "kernels/stencil.hpp"

namespace jaxmpm {

/// Constants of one step.
template <class T>
struct StepConstants {
  T dt, cell_size, flip_fraction;
  T volume_averaging = T(0);
};

/// What W particles give to the grid, in groups of V values: m v at rest, per axis m C Δx for the affine velocity, and −Δt V σ times 1/Δx
/// (slopes) or Δx D⁻¹ (moments) for the force. m and, where θ is kept, m θ: in 3D in the first quad and in one of its own, in 2D by themselves.
template <class Sch>
struct Coefficients {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, V = Sch::V, W = batch<T>;
  using P = Pack<T, W>;
  static constexpr bool affine_and_force = Sch::affine && Sch::mls;  // both ride on d: one set of groups
  static constexpr int affine = 1;
  static constexpr int force = Sch::affine && !Sch::mls ? 1 + Dim : 1;
  static constexpr int ends = force + Dim;  // groups before θ
  static constexpr int mass = Dim == 3 ? 0 : V * ends, theta = !Sch::dilation ? -1 : (Dim == 3 ? V * ends : V * ends + 1);
  static constexpr int size = Dim == 3 ? V * (ends + int(Sch::dilation)) : V * ends + 1 + int(Sch::dilation);
  P value[round_up(size, W)];  // room for the transposition in 3D
  P m, growth, per_mass;       // growth: 1/(1 + e), per_mass: −Δt V / (m Δx) (times Δx² D⁻¹)
  using Stress = T[Symmetric<T, Dim>::size][W];

  /// FLIP keeps the momentum and the impulse of the forces apart.
  static constexpr PlaneTerms in_plane(int plane) {
    constexpr int moments = Sch::mls ? force : (Sch::affine ? affine : -1), slopes = Sch::mls ? -1 : force;
    constexpr int second = Dim == 3 && Sch::dilation ? ends : -1;
    if (Sch::flip) return plane == 0 ? PlaneTerms{0, -1, -1} : PlaneTerms{second, moments, slopes};
    return plane == 0 ? PlaneTerms{0, moments, slopes} : PlaneTerms{second, -1, -1};
  }

  /// `sigma`: room for the stress, beside the object, which can then stay in registers.
  JAXMPM_INLINE Coefficients(const ParticleView<T, Dim>& p, std::size_t s, int count, const MaterialKernel<T, Dim>& material,
                             const StepConstants<T>& step, Stress& sigma) {
    for (P& x : value) x = P(T(0));
    const auto component = [&](int group, int c) -> P& { return value[V * group + Sch::vector_at + c]; };
    value[mass] = m = load(p.mass.data() + s, count);
    for (int c = 0; c < Dim; ++c) component(0, c) = m * load(p.velocity[std::size_t(c)].data() + s, count);
    if constexpr (Sch::dilation)
      if (!p.dilation.empty()) value[theta] = m * load(p.dilation[0].data() + s, count);
    if constexpr (Sch::affine) {
      const P scale = m * P(step.cell_size);
      for (int c = 0; c < Dim; ++c)
        for (int k = 0; k < Dim; ++k) component(affine + k, c) = scale * load(p.affine[std::size_t(c * Dim + k)].data() + s, count);
    }
    material.stress(p, s, count, sigma);
    growth = P(T(1)) / (P(T(1)) + load(p.compression.data() + s, count));
    per_mass = P(-step.dt * (Sch::gradient_scale / step.cell_size) / material.reference_density()) * growth;
    const P impulse = m * per_mass;
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) component(force + k, c) += impulse * P::load(sigma[Symmetric<T, Dim>::index(c, k)]);
  }
};

/// Scatters particles [begin, end) of a body to `arena`, which it clears first. `origin`: node 0 of the arena.
template <class Sch>
void p2g_tile(const ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end,
              const MaterialKernel<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step,
              const Index<Sch::Dim>& origin, typename Sch::T* arena) {
  using T = typename Sch::T;
  using Q = Coefficients<Sch>;
  Scatter<Sch, true> nodes(arena);
  for_each_batch<T>(begin, end, [&](std::size_t s, int count) JAXMPM_INLINE_LAMBDA {
    const Stencils<Sch, Sch::p2g_moments, Sch::p2g_slopes> t(p, s, count, origin);
    alignas(64) typename Q::Stress sigma;
    Q q(p, s, count, material, step, sigma);
    nodes.add(t, count, ParticleValues<Sch, Q>(q.value));
  });
  nodes.finish();
}

}  // namespace jaxmpm
