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
  JAXMPM_INLINE auto update_adjoint(const Matrix<Real, Dim>& H, Real, Real compression, const Real* history, Real& by_compression,
                                    Real* by_history, Matrix<Real, Dim>& by_H, Real* by_constants) const {
    const Real by_theta = compress_adjoint(compression, trace(H), by_compression);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) by_H(i, j) = i == j ? by_theta : Real(0);
    Symmetric<Real, Dim> by = read_symmetric<Real, Dim>(by_history);
    this->elasticity.trial_stress_adjoint(read_symmetric<Real, Dim>(history), H, by, by_H, by_constants[1], by_constants[2]);
    write_symmetric(by, by_history);
    return no_kink<Real>();
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    write_symmetric(stress, history);
  }
};

}  // namespace jaxmpm
