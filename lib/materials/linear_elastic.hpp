#pragma once
// Isotropic linear elasticity in rate form: Jaumann rate of the Cauchy stress, integrated with the exact rotation of Hughes & Winget
// (elastic.hpp). For small strains and any rotation; a cycle of large strain does not return to zero stress (use neo_hookean there).
#include "materials/elastic.hpp"

namespace jaxmpm {

template <class Scalar>
struct LinearElastic {
  Scalar density;  // ρ0, kg/m³
  IsotropicElasticity<Scalar> elasticity;

  static LinearElastic from(const deck::LinearElastic& m) {
    const ElasticModuli moduli = elastic_moduli(m);
    return {Scalar(m.density), {Scalar(moduli.bulk), Scalar(moduli.shear)}};
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int history_size() {
    return Symmetric<Scalar, Dim>::size;
  }
  template <int Dim>
  static constexpr JAXMPM_INLINE int plastic_strain_index() {
    return -1;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Real update(const Matrix<Real, Dim>& H, Real, Real& compression, Real* history) const {
    compression = compress(compression, trace(H));
    write_symmetric(elasticity.trial_stress(read_symmetric<Real, Dim>(history), H), history);
    return Real(0);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> stress(Real, const Real* history) const {
    return read_symmetric<Real, Dim>(history);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Real wave_speed(Real compression, const Real*) const {
    return elasticity.wave_speed(density, compression);
  }

  JAXMPM_INLINE Scalar diffusivity() const { return Scalar(0); }

  template <class Real, int Dim>
  JAXMPM_INLINE Real energy(Real, const Real* history) const {
    return elasticity.energy(read_symmetric<Real, Dim>(history));
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    write_symmetric(stress, history);
  }
};

}  // namespace jaxmpm
