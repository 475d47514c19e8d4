#pragma once
// Adjoint of the transfer from particles to grid on a device: a gather of the derivatives by the nodes' sums, a thread a particle.
#include "kernels/device/adjoint/contract.hpp"
#include "kernels/device/g2p.hpp"

namespace jaxmpm {

template <class Sch, class Law, class Space>
struct ScatterAdjoint {
  using T = typename Sch::T;
  using Gift = StepGift<Sch, Law>;
  static constexpr int Dim = Sch::Dim;
  static constexpr std::size_t scratch = Sch::arena_size * sizeof(T) + 16;
  static constexpr int threads = 128, resident = sizeof(T) == 4 ? 3 : 2;
  ParticleFields<T, Dim> particles, bars;
  TileTable<T, Dim> table;
  Law law;
  StepConstants<T> step;
  const int* neighbour;  // Blocks::neighbour
  const T* by_sums;      // [block][own]
  double* body;          // of ConstantBars

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    MaterialBars<Law> mine;
    for_each_particle<Sch>(team, table, neighbour, by_sums, particles, [&](std::size_t p, const Cell<Sch>& cell, const T* arena) {
      const Factors<Sch> factors(cell.offset);
      move(p, cell, factors, arena);
      fields(p, Sums(factors, cell.base, arena), mine);
    });
    mine.give(team, body);
  }

 private:
  /// Derivatives by a particle's shares.
  struct Sums {
    T value[1 + Dim];                       // by mass and momentum
    T moments[Dim][Dim], slopes[Dim][Dim];  // [axis][component]
    JAXMPM_INLINE Sums(const Factors<Sch>& factors, int base, const T* arena) {
      if constexpr (Sch::flip) {
        take(PlaneSums<Sch, false, false, 0, 1 + Dim>(factors, base, arena).value);
        take(PlaneSums<Sch, Gift::with_d, Gift::with_g, 1, Dim>(factors, base, arena + Sch::arena_plane), 0);
      } else {
        const PlaneSums<Sch, Gift::with_d, Gift::with_g, 0, 1 + Dim> sum(factors, base, arena);
        take(sum.value), take(sum, 1);
      }
    }

   private:
    JAXMPM_INLINE void take(const T (&from)[1 + Dim]) {
      for (int c = 0; c <= Dim; ++c) value[c] = from[c];
    }
    template <class Plane>
    JAXMPM_INLINE void take(const Plane& sum, int first) {
      for (int k = 0; k < Dim; ++k)
        for (int c = 0; c < Dim; ++c) moments[k][c] = sum.moments[k][first + c], slopes[k][c] = sum.slopes[k][first + c];
    }
  };

  /// The factors follow the particle's place.
  JAXMPM_INLINE void move(std::size_t p, const Cell<Sch>& cell, const Factors<Sch>& factors, const T* arena) const {
    Share<T, Dim> shares[1 + Dim];  // of mass and momentum
    Gift(law, step).share(particles, p, shares);
    T by_x[Dim] = {};
    if constexpr (Sch::flip) {
      Contraction<Sch, false, false, 0, 1 + Dim>(factors, cell.offset, shares).add(arena, cell.base, by_x);
      for (Share<T, Dim>& share : shares) share.plain = T(0);
      Contraction<Sch, Gift::with_d, Gift::with_g, 1, Dim>(factors, cell.offset, shares + 1).add(arena + Sch::arena_plane, cell.base, by_x);
    } else {
      Contraction<Sch, Gift::with_d, Gift::with_g, 0, 1 + Dim, 1>(factors, cell.offset, shares).add(arena, cell.base, by_x);
    }
    for (int axis = 0; axis < Dim; ++axis) bars.position(axis, p) += double(by_x[axis]);
  }

  /// What the derivatives by a particle's shares bring to its fields.
  JAXMPM_INLINE void fields(std::size_t p, const Sums& by, MaterialBars<Law>& mine) const {
    const T m = particles.mass(p);
    T by_mass = by.value[0];
    for (int c = 0; c < Dim; ++c) {
      by_mass += by.value[1 + c] * particles.velocity(c, p);
      bars.velocity(c, p) += m * by.value[1 + c];
      if constexpr (Sch::affine)
        for (int k = 0; k < Dim; ++k) {
          const T by_affine = step.cell_size * by.moments[k][c];
          by_mass += by_affine * particles.affine(c * Dim + k, p);
          bars.affine(c * Dim + k, p) += m * by_affine;
        }
    }
    StateBars<Law, T, Dim> state(particles, bars, p);
    const Symmetric<T, Dim> sigma = law.template stress<T, Dim>(state.e, state.h);
    const T growth = T(1) / (T(1) + state.e);
    const T per_mass = -step.dt * (Sch::gradient_scale / step.cell_size) / law.density * growth, impulse = m * per_mass;
    T by_impulse(0);
    Symmetric<T, Dim> by_sigma{};
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        const T force = Sch::mls ? by.moments[k][c] : by.slopes[k][c];
        by_impulse += force * sigma(c, k);
        by_sigma[Symmetric<T, Dim>::index(c, k)] += impulse * force;
      }
    bars.mass(p) += by_mass + by_impulse * per_mass;
    const T by_volume = by_impulse * impulse;
    state.by_e -= by_volume * growth;
    state.by_constants[0] = -by_volume / law.density;
    law.template stress_adjoint<T, Dim>(state.e, state.h, by_sigma, state.by_e, state.by_h, state.by_constants);
    state.store(bars, p, mine);
  }
};

}  // namespace jaxmpm
