#pragma once
// From derivatives by a snapshot, in order of ids, to those by the particles' fields in storage order; and back from a sorted order.
#include "kernels/device/adjoint/contract.hpp"

namespace jaxmpm {

/// Derivatives by the fields of a body's snapshot in the device's memory, null where there are none (solvers/model_gradient.hpp).
struct SnapshotBars {
  const double *position, *velocity;                       // [particle][Dim], per m and per m/s
  const double *mass, *density, *plastic_strain, *stress;  // [particle], stress [particle][6]
};

/// Adds those by a snapshot to those by the fields.
template <class T, int Dim, class Law, class Space>
struct AddSnapshot {
  static constexpr int threads = 128;
  ParticleFields<T, Dim> particles, bars;
  SnapshotBars by;
  std::size_t count;
  std::uint32_t first_id;
  double cell_size;
  Law law;
  double* body;  // of ConstantBars

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    MaterialBars<Law> mine;
    const std::size_t begin = std::size_t(team.league_rank()) * threads;
    team_for(team, int(count - begin < threads ? count - begin : threads), [&](int i) { add(begin + std::size_t(i), mine); });
    mine.give(team, body);
  }

 private:
  JAXMPM_INLINE void add(std::size_t p, MaterialBars<Law>& mine) const {
    constexpr int strain = Law::template plastic_strain_index<Dim>();
    const std::size_t i = particles.ids[p] - first_id;
    for (int d = 0; d < Dim; ++d) {
      if (by.position) bars.position(d, p) += cell_size * by.position[i * Dim + std::size_t(d)];
      if (by.velocity) bars.velocity(d, p) += T(by.velocity[i * Dim + std::size_t(d)]);
    }
    if (by.mass) bars.mass(p) += T(by.mass[i]);
    if constexpr (strain >= 0)
      if (by.plastic_strain) bars.history(strain, p) += T(by.plastic_strain[i]);
    if (by.density) {  // ρ = ρ0 (1 + e)
      bars.compression(p) += T(double(law.density) * by.density[i]);
      mine.by_constants[0] += (1 + double(particles.compression(p))) * by.density[i];
    }
    if (by.stress) add_stress(p, by.stress + 6 * i, mine);
  }

  JAXMPM_INLINE void add_stress(std::size_t p, const double* by_stress, MaterialBars<Law>& mine) const {
    StateBars<Law, T, Dim> state(particles, bars, p);
    Symmetric<T, Dim> by_sigma{};
    for (int k = 0; k < by_sigma.size; ++k) by_sigma[k] = T(by_stress[k]);
    law.template stress_adjoint<T, Dim>(state.e, state.h, by_sigma, state.by_e, state.by_h, state.by_constants);
    state.store(bars, p, mine);
  }
};

/// place[id less the first]: where the particle lies.
struct NotePlaces {
  const std::uint32_t* ids;
  std::uint32_t first_id;
  std::uint32_t* place;
  JAXMPM_INLINE void operator()(std::size_t p) const { place[ids[p] - first_id] = std::uint32_t(p); }
};

/// Copies fields to the places that their particles had: `ids` are those of `from`.
template <class T, int Dim>
struct Unsort {
  ParticleFields<T, Dim> from, to;
  const std::uint32_t *ids, *place;
  std::uint32_t first_id;
  int rows;
  JAXMPM_INLINE void operator()(std::size_t p) const {
    const std::size_t q = place[ids[p] - first_id];
    for (int d = 0; d < Dim; ++d) to.position(d, q) = from.position(d, p);
    for (int k = 0; k < rows; ++k) to.row(k, q) = from.row(k, p);
  }
};

}  // namespace jaxmpm
