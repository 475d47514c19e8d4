#pragma once
// A material as the transfer kernels see it: stress and update of a batch of particles. One virtual call per batch keeps materials and
// schemes from multiplying.
#include <memory>

#include "core/pack.hpp"
#include "core/tensor.hpp"
#include "scene/model.hpp"
#include "state/particle_view.hpp"

namespace jaxmpm {

/// What a tile reports of a step, gathered batch by batch in storage order.
struct TileReport {
  double fastest = 0;                // largest c + |v|, m/s
  double displacement = 0;           // largest |Δx| along an axis, cells
  double plastic = 0, viscous = 0;   // energy dissipated, J (only where accounted)
  bool sound = true, inside = true;  // every value finite, every particle inside the domain
};

template <class T, int Dim>
class MaterialKernel {
 public:
  virtual ~MaterialKernel() = default;
  virtual T reference_density() const = 0;
  /// Wave speed aside, what bounds Δt: diffusivity in m²/s, 0 where there is none.
  virtual double diffusivity() const = 0;
  virtual int history_size() const = 0;
  /// Place of plastic strain in the history, −1 where there is none.
  virtual int plastic_strain_index() const = 0;

  /// Cauchy stress of `count` particles from s: sigma[component][lane], Pa.
  virtual void stress(const ParticleView<T, Dim>& p, std::size_t s, int count, T sigma[][native_lanes<T>]) const = 0;
  /// Advances compression and history of `count` particles from s by H = Δt∇v (H[component][lane]), in place; speed[lane]: |v|, for c +
  /// |v|.
  virtual void update(ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][native_lanes<T>], const T speed[native_lanes<T>], T dt,
                      bool account, TileReport& report) const = 0;

  // One particle at a time, double precision: set-up and output.
  virtual void start(const double stress[6], double compression, double* history) const = 0;
  virtual void stress(double compression, const double* history, double stress[6]) const = 0;
  virtual double energy(double compression, const double* history) const = 0;  // J/m³
  virtual double wave_speed(double compression, const double* history) const = 0;
};

/// The kernel of a deck's material.
template <class T, int Dim>
std::unique_ptr<MaterialKernel<T, Dim>> make_material_kernel(const deck::Material& material);

}  // namespace jaxmpm
