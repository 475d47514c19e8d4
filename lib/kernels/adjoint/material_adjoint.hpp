#pragma once
// The adjoint of a material on batches of particles, beside MaterialKernel.
#include <array>
#include <memory>

#include "core/pack.hpp"
#include "core/tensor.hpp"
#include "deck/deck.hpp"
#include "state/particle_view.hpp"

namespace jaxmpm {

/// Derivatives by the constants of a law, in the order of Law::constants; and particles whose branch hangs on round-off.
struct MaterialReport {
  static constexpr int most_constants = 8;
  std::array<double, most_constants> constants{};
  std::uint64_t at_kinks = 0;
};

/// Vector–Jacobian products. `p` is the state at the start of the step, `bar` holds derivatives of the loss by the particles' fields.
template <class T, int Dim>
class MaterialAdjoint {
 public:
  static constexpr int W = native_lanes<T>;
  virtual ~MaterialAdjoint() = default;
  /// Of MaterialKernel::update, `count` particles from s. In bar, compression and history by their end values become those by their start
  /// values; by_H[component][lane] receives the derivatives by H.
  virtual void update(const ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][W], T dt, ParticleView<T, Dim>& bar, T by_H[][W],
                      MaterialReport& report) const = 0;
  /// Of MaterialKernel::stress: adds to compression and history in bar what by_sigma[component][lane] brings.
  virtual void stress(const ParticleView<T, Dim>& p, std::size_t s, int count, const T by_sigma[][W], ParticleView<T, Dim>& bar,
                      MaterialReport& report) const = 0;
  /// Of MaterialKernel::start, all particles: `p` is the first state, `bar` by it; by_compression[particle] and by_stress[particle][6]
  /// receive the derivatives by what it was made from.
  virtual void start(const Particles<T, Dim>& p, const Particles<T, Dim>& bar, double* by_compression, double* by_stress,
                     MaterialReport& report) const = 0;
};

/// The adjoint of a deck's material.
template <class T, int Dim>
std::unique_ptr<MaterialAdjoint<T, Dim>> make_material_adjoint(const deck::Material& material);

}  // namespace jaxmpm
