#pragma once
// The particles of a model on the host, as every backend starts, shows, saves and restores them.
#include "kernels/material_kernel.hpp"
#include "solvers/solver.hpp"
#include "state/blocks.hpp"

namespace jaxmpm {

/// What a stepper's state holds besides the particles' fields.
struct StepNumbers {
  double drift = 0;    // largest way since the last sort, cells
  double fastest = 0;  // largest c + |v| of the present state, m/s
  double last_dt = 0;  // s
  double time = 0;     // s
  Dissipation dissipation;
};

template <class T, int Dim>
using MaterialKernels = std::vector<std::unique_ptr<MaterialKernel<T, Dim>>>;  // [body]

/// First state of a body, unsorted; `fastest` becomes its largest c + |v| where that is larger.
template <class T, int Dim>
Particles<T, Dim> first_particles(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, double& fastest);

/// Largest stable step: CFL on c + |v| and the viscous limit, s.
template <class T, int Dim>
double stable_step(const Model& model, const MaterialKernels<T, Dim>& materials, double fastest);

/// Where the particles of a snapshot lie in storage.
using Slots = std::vector<std::uint32_t>;

/// Those of all particles of a body, in order of ids or as they lie; without those that have left (mass 0).
template <class T, int Dim>
Slots all_slots(const Particles<T, Dim>& particles, bool ordered);

/// Those of each body's particles that may be within regions: of the tiles that a particle there may belong to. `drift`: largest way since
/// the sort, cells.
template <int Dim>
std::vector<Slots> slots_within(const Model& model, const Blocks<Dim>& blocks, double drift, const std::vector<Region>& regions);

/// Fields of some particles of a body in deck coordinates, in the order of their slots, into a snapshot whose memory is used again.
template <class T, int Dim>
void take_body_snapshot(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, const Particles<T, Dim>& particles,
                        const FieldSelection& fields, const Slots& slots, BodySnapshot& snapshot);

/// Arrays of a checkpoint, and back. Particles drift after a sort: which tile they belong to is state. restore_state() wants bodies of the
/// right sizes, except where some particles `may_have_left`; throws IoError when arrays are missing or do not fit.
template <class T, int Dim>
std::vector<RawArray> save_state(const std::vector<Particles<T, Dim>>& bodies, const std::vector<Tile>& tiles,
                                 const std::vector<std::int64_t>& tile_key, const StepNumbers& numbers);
template <class T, int Dim>
void restore_state(const std::vector<RawArray>& arrays, std::vector<Particles<T, Dim>>& bodies, std::vector<Tile>& tiles,
                   std::vector<std::int64_t>& tile_key, StepNumbers& numbers, bool may_have_left = false);

/// Takes particles [begin, end) that have passed an open face out of the run: without mass they give nothing to the grid.
template <class T, int Dim>
void release_leavers(const Model& model, Particles<T, Dim>& particles, std::size_t begin, std::size_t end);
/// Removes the particles that have left. The others keep their order.
template <class T, int Dim>
void remove_leavers(Particles<T, Dim>& particles);

/// Throws NumericsError when one of particles [begin, end) has left the domain or has a state, or a wave speed, that is not finite.
template <class T, int Dim>
void check_particles(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, const Particles<T, Dim>& particles,
                     std::size_t begin, std::size_t end);

}  // namespace jaxmpm
