#pragma once
// Isotropic linear elasticity in rate form: Jaumann rate of the Cauchy stress, integrated with the exact rotation of Hughes & Winget
// (elastic.hpp). For small strains and any rotation; a cycle of large strain does not return to zero stress (use neo_hookean there).
#include "materials/elastic.hpp"

namespace jaxmpm {

template <class Scalar>
struct LinearElastic : RateElastic<Scalar> {
  template <class Number = DeckNumber>
  static LinearElastic from(const deck::LinearElastic& m, const Number& number = {}) {
    const auto moduli = elastic_moduli(m, number);
    return {{Scalar(number(m.density)), {Scalar(moduli.bulk), Scalar(moduli.shear)}}};
  }
  template <class Law>
  static auto constants(Law& law) {
    return std::array{&law.density, &law.elasticity.bulk, &law.elasticity.shear};
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
    write_symmetric(this->elasticity.trial_stress(read_symmetric<Real, Dim>(history), H), history);
    return Real(0);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    write_symmetric(stress, history);
  }
};

}  // namespace jaxmpm
