#pragma once
// The stepper as the rest of the program sees it. One instance runs one model on one backend in one precision.
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/model.hpp"

namespace jaxmpm {

/// Particle fields of one body on the host, double precision, deck coordinates and units. Fields not asked for stay empty.
struct BodySnapshot {
  std::vector<std::uint32_t> id;
  std::vector<double> position;           // N × dim, m
  std::vector<double> velocity;           // N × dim, m/s
  std::vector<double> mass;               // N, kg
  std::vector<double> density;            // N, kg/m³
  std::vector<double> pressure;           // N, Pa, positive in compression: −tr σ / 3
  std::vector<double> stress;             // N × 6, Pa, xx yy zz xy yz xz (tension positive), also in 2D
  std::vector<double> velocity_gradient;  // N × dim × dim, 1/s
  std::vector<double> plastic_strain;     // N (zero where the material has none)
  std::vector<double> strain_energy;      // N, J
};
struct FieldSelection {
  bool velocity = false, density = false, pressure = false, stress = false, velocity_gradient = false, plastic_strain = false,
       energy = false;
};

/// A box, m: from min to max along each axis of the model.
struct Region {
  Point min{}, max{};
};

/// Sums since the start of the run, J: dissipation that an energy gauge reports. Zero unless model.account_energy.
struct Dissipation {
  double plastic = 0, viscous = 0, friction = 0;
};

/// One array of a checkpoint: raw bytes with their type ("f4", "f8", "u4", "i8") and shape.
struct RawArray {
  std::string name, type;
  std::vector<std::size_t> shape;
  std::vector<unsigned char> bytes;
};
/// A solver's state, which several may look at.
using SavedState = std::shared_ptr<const std::vector<RawArray>>;

/// Seconds spent in each phase of the step since the start of the run.
struct PhaseSeconds {
  double sort = 0, p2g = 0, grid = 0, g2p = 0;
};

/// Impulse that a wall face or obstacle has given to the material during the last step divided by Δt, N.
struct ContactForces {
  std::array<Point, 6> face{};
  std::vector<Point> obstacle;
};

class Solver {
 public:
  virtual ~Solver() = default;
  /// Largest stable step of the present state (CFL on c + |v|, viscous limit), s; depends on the state alone.
  virtual double stable_step() const = 0;
  /// One explicit step (Du & He 2025, Eqs 9–18). Throws NumericsError naming particle, place and time; the state is then not to be used.
  virtual void step(double dt) = 0;
  virtual std::uint64_t particle_count() const = 0;
  /// Fields of every body, in deck order; `ordered` sorts by id, otherwise storage order (a deterministic one).
  std::vector<BodySnapshot> snapshot(const FieldSelection& fields, bool ordered) const {
    std::vector<BodySnapshot> bodies;
    take_snapshot(fields, ordered, bodies);
    return bodies;
  }
  /// The same into the memory of an earlier one, which need not be cleared by the system then.
  virtual void take_snapshot(const FieldSelection& fields, bool ordered, std::vector<BodySnapshot>& bodies) const = 0;
  /// The same of all particles within the regions, and maybe of others around them, in storage order: what a look at few places costs.
  virtual std::vector<BodySnapshot> snapshot_within(const std::vector<Region>& regions, const FieldSelection& fields) const = 0;
  /// Forces are gathered only after this is switched on (it costs a little).
  virtual void record_forces(bool on) = 0;
  virtual ContactForces forces() const = 0;
  virtual Dissipation dissipation() const = 0;
  /// Whole state, so that restoring it continues to the same bits. restore() throws IoError when arrays are missing or of the wrong shape.
  virtual std::vector<RawArray> save() const = 0;
  virtual void restore(const std::vector<RawArray>& arrays) = 0;
  virtual double bytes_per_particle() const = 0;
  virtual PhaseSeconds phase_seconds() const = 0;
  virtual std::size_t active_blocks() const = 0;
  /// How often particles have been sorted so far.
  virtual std::uint64_t sorts() const = 0;
  /// Particles that the next step leaves where they are (/method/rest).
  virtual std::uint64_t particles_at_rest() const { return 0; }
};

enum class Backend { cpu, cuda };

/// Builds the stepper for a model: picks dimension, precision, basis, transfer and gradient at run time among the compiled specialisations.
/// Throws Error (exit 2) when the backend is not in this build or no device is found.
std::unique_ptr<Solver> make_solver(const Model& model, Backend backend);
bool has_backend(Backend backend);

/// Limit of the step of a solver's present state, s: that of /time/cfl 1.
double step_limit(const Model& model, const Solver& solver);
/// What to say where a fixed step is beyond it; empty where none is.
std::string large_step_warning(const Model& model, const Solver& solver);
/// What to say of granular bodies that still move at the end of a run, at `time` s, whose deposits are not final: those of which over a
/// hundredth of the mass would pass a cell in half of that time again. Empty where there are none.
std::string moving_note(const Model& model, const Solver& solver, double time);

}  // namespace jaxmpm
