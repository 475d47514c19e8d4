#pragma once
// Adjoint of the transfer from grid to particles and of the stress update on a device: a thread a particle, which leaves the derivatives by
// what it gathered in a table; ScatterTiles then scatters these as it does a step's momenta.
#include "kernels/device/adjoint/contract.hpp"
#include "kernels/device/g2p.hpp"

namespace jaxmpm {

/// Derivatives by the sums that particles gathered, [row][stride]: of each component by Σ w v, with FLIP by Σ w Δv, by Σ d v and Σ g v of
/// all axes. A `Gift` of the scatter (shares.hpp).
template <class Sch>
struct GatheredBarTable {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  static constexpr bool mass = false, with_d = Sch::g2p_moments, with_g = Sch::g2p_slopes, second_plain = Sch::flip;
  static constexpr int full = 0;
  static constexpr int first_d = 1 + int(second_plain), first_g = first_d + (with_d ? Dim : 0), of_component = first_g + (with_g ? Dim : 0);
  static constexpr int rows = Dim * of_component;
  T* table;
  std::size_t stride;

  JAXMPM_INLINE T& at(int row, std::size_t p) const { return table[std::size_t(row) * stride + p]; }
  JAXMPM_INLINE void write(const ParticleFields<T, Dim>&, std::size_t p, const Cell<Sch>& cell, T* record) const {
    for (int k = 0; k < Dim; ++k) *record++ = cell.offset[k];
    for (int k = 0; k < rows; ++k) *record++ = at(k, p);
  }
};

template <class Sch, class Law, class Space>
struct GatherAdjoint {
  using T = typename Sch::T;
  using Out = GatheredBarTable<Sch>;
  static constexpr int Dim = Sch::Dim;
  static constexpr std::size_t scratch = Sch::arena_size * sizeof(T) + 16;
  static constexpr int threads = 128, resident = sizeof(T) == 4 ? 3 : 2;
  ParticleFields<T, Dim> particles, bars;
  TileTable<T, Dim> table;
  Law law;
  StepConstants<T> step;
  const int* neighbour;  // Blocks::neighbour
  const T* grid;         // [block][own]: velocities
  Index<Dim> cells;      // of the domain
  Out out;
  double *flip_fraction, *body;  // places of ConstantBars

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    MaterialBars<Law> mine;
    double by_flip = 0;
    for_each_particle<Sch>(team, table, neighbour, grid, particles,
                           [&](std::size_t p, const Cell<Sch>& cell, const T* arena) { update(p, cell, arena, mine, by_flip); });
    mine.give(team, body);
    if constexpr (Sch::flip) MaterialBars<Law>::give_sum(team, by_flip, flip_fraction);
  }

 private:
  /// Derivatives by what a particle gathered.
  struct By {
    Share<T, Dim> component[Dim] = {};
    T change[Dim] = {};  // FLIP
    JAXMPM_INLINE T& affine(int c, int k) { return Sch::affine_by_moments ? component[c].d[k] : component[c].g[k]; }
    JAXMPM_INLINE T& gradient(int c, int k) { return Sch::mls ? component[c].d[k] : component[c].g[k]; }
  };

  JAXMPM_INLINE void update(std::size_t p, const Cell<Sch>& cell, const T* arena, MaterialBars<Law>& mine, double& by_flip) const {
    const Factors<Sch> factors(cell.offset);
    const Gathered<Sch> sum(factors, cell.base, arena);
    const GatherScales<Sch> scales(step);
    By by;
    for (int c = 0; c < Dim; ++c) {  // x ← x + Δt v, and the velocity
      const T end = bars.velocity(c, p);
      const double X = particles.position(c, p) + double(scales.move * sum.value[c]);
      if (X < 0.0 || X > double(cells[std::size_t(c)])) bars.position(c, p) = 0.0;  // a face holds it
      by.component[c].plain = scales.move * T(bars.position(c, p));
      if constexpr (Sch::flip) {
        by.component[c].plain += (T(1) - step.flip_fraction) * end;
        by.change[c] = step.flip_fraction * end;
        by_flip += double(end * (particles.velocity(c, p) + sum.change[c] - sum.value[c]));
        bars.velocity(c, p) = step.flip_fraction * end;
      } else {
        by.component[c].plain += end;
        bars.velocity(c, p) = T(0);
      }
      if constexpr (Sch::affine)
        for (int k = 0; k < Dim; ++k) {
          by.affine(c, k) += scales.affine * bars.affine(c * Dim + k, p);
          bars.affine(c * Dim + k, p) = T(0);
        }
    }
    material(p, sum, scales, by, mine);
    move(p, cell, factors, arena, by);
    for (int c = 0; c < Dim; ++c) write(p, c, by);
  }

  /// The stress update: from its end values to its start values and the increment of deformation.
  JAXMPM_INLINE void material(std::size_t p, const Gathered<Sch>& sum, const GatherScales<Sch>& scales, By& by,
                              MaterialBars<Law>& mine) const {
    const T rate = step.dt * scales.gradient;
    Matrix<T, Dim> H, by_H;
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) H(c, k) = rate * (Sch::mls ? sum.moments[k][c] : sum.slopes[k][c]);
    StateBars<Law, T, Dim> state(particles, bars, p);
    const auto kink = law.template update_adjoint<T, Dim>(H, step.dt, state.e, state.h, state.by_e, state.by_h, by_H, state.by_constants);
    state.store(bars, p, mine);
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) by.gradient(c, k) += rate * by_H(c, k);
    mine.kinks += kink ? 1 : 0;
  }

  /// The factors follow the particle's place.
  JAXMPM_INLINE void move(std::size_t p, const Cell<Sch>& cell, const Factors<Sch>& factors, const T* arena, const By& by) const {
    T by_x[Dim] = {};
    Contraction<Sch, Out::with_d, Out::with_g, 1, Dim>(factors, cell.offset, by.component).add(arena, cell.base, by_x);
    if constexpr (Sch::flip) {
      Share<T, Dim> change[Dim];
      for (int c = 0; c < Dim; ++c) change[c].plain = by.change[c];
      Contraction<Sch, false, false, 1, Dim>(factors, cell.offset, change).add(arena + Sch::arena_plane, cell.base, by_x);
    }
    for (int axis = 0; axis < Dim; ++axis) bars.position(axis, p) += double(by_x[axis]);
  }

  JAXMPM_INLINE void write(std::size_t p, int c, const By& by) const {
    const int row = c * Out::of_component;
    out.at(row, p) = by.component[c].plain;
    if constexpr (Out::second_plain) out.at(row + 1, p) = by.change[c];
    for (int k = 0; k < Dim; ++k) {
      if constexpr (Out::with_d) out.at(row + Out::first_d + k, p) = by.component[c].d[k];
      if constexpr (Out::with_g) out.at(row + Out::first_g + k, p) = by.component[c].g[k];
    }
  }
};

}  // namespace jaxmpm
