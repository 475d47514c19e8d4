#pragma once
// Isotropic linear elasticity with an objective rate: what linear_elastic and drucker_prager share; and the elastic constants of a deck's
// materials.
#include <array>
#include <optional>
#include <variant>

#include "deck/deck.hpp"
#include "materials/material.hpp"

namespace jaxmpm {

/// R − I = 2 (S + S²)/(1 + a²) of the turn in a step, with S = W/2, W = (H − Hᵀ)/2 and a² = −tr S²/2.
template <class Real, int Dim>
struct Turn {
  Matrix<Real, Dim> S, sum, E;  // S, S + S² and R − I
  Real scale;                   // 2/(1 + a²)

  JAXMPM_INLINE explicit Turn(const Matrix<Real, Dim>& H) {
    Real a2 = Real(0);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) S(i, j) = Real(0.25) * (H(i, j) - H(j, i));
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < i; ++j) a2 = a2 + S(i, j) * S(i, j);
    scale = Real(2) / (Real(1) + a2);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        sum(i, j) = S(i, j);
        for (int k = 0; k < Dim; ++k) sum(i, j) = sum(i, j) + S(i, k) * S(k, j);
        E(i, j) = scale * sum(i, j);
      }
  }
  /// (R − I) σ.
  JAXMPM_INLINE Matrix<Real, Dim> apply(const Symmetric<Real, Dim>& stress) const {
    Matrix<Real, Dim> ES;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        ES(i, j) = E(i, 0) * stress(0, j);
        for (int k = 1; k < Dim; ++k) ES(i, j) = ES(i, j) + E(i, k) * stress(k, j);
      }
    return ES;
  }
};

/// R σ Rᵀ with R = (I − W/2)⁻¹ (I + W/2), W = (H − Hᵀ)/2: the Cayley transform of Hughes & Winget (1980), exactly orthogonal, so that the
/// invariants of σ survive any number of turns (Du & He 2025, Eq A.2, is its first-order limit and lets J2 grow). With S = W/2 and
/// a² = −tr S²/2, R − I = 2 (S + S²)/(1 + a²); the difference from I is what is applied, so that single precision keeps small turns.
template <class Real, int Dim>
JAXMPM_INLINE Symmetric<Real, Dim> rotate(const Symmetric<Real, Dim>& stress, const Matrix<Real, Dim>& H) {
  const Turn<Real, Dim> turn(H);
  const Matrix<Real, Dim>&E = turn.E, ES = turn.apply(stress);
  Symmetric<Real, Dim> rotated = stress;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j <= i; ++j) {
      Real sum = ES(i, j) + ES(j, i);
      for (int k = 0; k < Dim; ++k) sum = sum + ES(i, k) * E(j, k);
      const int at = Symmetric<Real, Dim>::index(i, j);
      rotated[at] = rotated[at] + sum;
    }
  return rotated;
}

/// Adjoint of rotate(): `by` is by the rotated stress, then by the stress; adds to by_H.
template <class Real, int Dim>
JAXMPM_INLINE void rotate_adjoint(const Symmetric<Real, Dim>& stress, const Matrix<Real, Dim>& H, Symmetric<Real, Dim>& by,
                                  Matrix<Real, Dim>& by_H) {
  const Turn<Real, Dim> turn(H);
  const Matrix<Real, Dim>&S = turn.S, &E = turn.E, ES = turn.apply(stress);
  const Real scale = turn.scale;
  Matrix<Real, Dim> by_E, by_ES, by_S;
  for (int k = 0; k < Dim * Dim; ++k) by_E.a[k] = by_ES.a[k] = by_S.a[k] = Real(0);
  for (int i = 0; i < Dim; ++i)  // rotated = σ + ES + (ES)ᵀ + ES Eᵀ
    for (int j = 0; j <= i; ++j) {
      const Real b = by[Symmetric<Real, Dim>::index(i, j)];
      by_ES(i, j) = by_ES(i, j) + b, by_ES(j, i) = by_ES(j, i) + b;
      for (int k = 0; k < Dim; ++k) by_ES(i, k) = by_ES(i, k) + b * E(j, k), by_E(j, k) = by_E(j, k) + b * ES(i, k);
    }
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k) {
        const int at = Symmetric<Real, Dim>::index(k, j);
        by_E(i, k) = by_E(i, k) + by_ES(i, j) * stress(k, j), by[at] = by[at] + by_ES(i, j) * E(i, k);
      }
  Real by_scale = Real(0);
  for (int k = 0; k < Dim * Dim; ++k) by_scale = by_scale + by_E.a[k] * turn.sum.a[k];
  const Real by_a2 = Real(-0.5) * by_scale * scale * scale;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      const Real b = scale * by_E(i, j);
      by_S(i, j) = by_S(i, j) + b;
      if (j < i) by_S(i, j) = by_S(i, j) + Real(2) * by_a2 * S(i, j);
      for (int k = 0; k < Dim; ++k) by_S(i, k) = by_S(i, k) + b * S(k, j), by_S(k, j) = by_S(k, j) + b * S(i, k);
    }
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) by_H(i, j) = by_H(i, j) + Real(0.25) * (by_S(i, j) - by_S(j, i));
}

/// Bulk modulus K and shear modulus G, Pa.
template <class Scalar>
struct IsotropicElasticity {
  Scalar bulk, shear;

  /// Rσ Rᵀ + K tr(Δd) I + 2 G dev Δd, Δd = (H + Hᵀ)/2 (Du & He 2025, Eq A.1).
  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> trial_stress(const Symmetric<Real, Dim>& stress, const Matrix<Real, Dim>& H) const {
    const Symmetric<Real, Dim> strain = symmetric_part(H);
    const Symmetric<Real, Dim> shape = deviator(strain);
    Symmetric<Real, Dim> trial = rotate(stress, H);
    const Real pressure = Real(bulk) * trace(strain);
    for (int k = 0; k < trial.size; ++k) trial[k] = trial[k] + Real(2) * Real(shear) * shape[k];
    for (int k = 0; k < 3; ++k) trial[k] = trial[k] + pressure;
    return trial;
  }

  /// Adjoint of trial_stress(): `by` is by its result, then by the stress; adds to by_H and to the derivatives by K and G.
  template <class Real, int Dim>
  JAXMPM_INLINE void trial_stress_adjoint(const Symmetric<Real, Dim>& stress, const Matrix<Real, Dim>& H, Symmetric<Real, Dim>& by,
                                          Matrix<Real, Dim>& by_H, Real& by_bulk, Real& by_shear) const {
    const Symmetric<Real, Dim> strain = symmetric_part(H), shape = deviator(strain);
    const Real by_pressure = trace(by);
    by_bulk = by_bulk + by_pressure * trace(strain);
    Symmetric<Real, Dim> by_shape;
    for (int k = 0; k < by.size; ++k) {
      by_shear = by_shear + Real(2) * shape[k] * by[k];
      by_shape[k] = Real(2) * Real(shear) * by[k];
    }
    Symmetric<Real, Dim> by_strain = deviator_adjoint(by_shape);
    for (int k = 0; k < 3; ++k) by_strain[k] = by_strain[k] + Real(bulk) * by_pressure;
    symmetric_part_adjoint(by_strain, by_H);
    rotate_adjoint(stress, H, by, by_H);
  }

  /// σ : C⁻¹ : σ / 2 = J2/(2G) + σ_m²/(2K), J/m³.
  template <class Real, int Dim>
  JAXMPM_INLINE Real energy(const Symmetric<Real, Dim>& stress) const {
    const Real m = mean(stress);
    return Real(0.5) * (half_square(deviator(stress)) / Real(shear) + m * m / Real(bulk));
  }

  /// K + 4G/3: stiffness of a plane pressure wave, Pa.
  JAXMPM_INLINE Scalar wave_modulus() const { return bulk + Scalar(4.0 / 3.0) * shear; }

  /// Speed of a pressure wave at density ρ0 (1 + e), m/s.
  template <class Real>
  JAXMPM_INLINE Real wave_speed(Scalar density, Real compression) const {
    return sqrt(Real(wave_modulus()) / (Real(density) * (Real(1) + compression)));
  }
};

/// What solids with a stress rate share: parameters and everything but the update. The first history values are the Cauchy stress.
template <class Scalar>
struct RateElastic {
  Scalar density;  // ρ0, kg/m³
  IsotropicElasticity<Scalar> elasticity;

  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> stress(Real, const Real* history) const {
    return read_symmetric<Real, Dim>(history);
  }
  static constexpr bool by_hand = true;
  template <class Real, int Dim>
  JAXMPM_INLINE void stress_adjoint(Real, const Real*, const Symmetric<Real, Dim>& by_sigma, Real&, Real* by_history, Real*) const {
    for (int k = 0; k < by_sigma.size; ++k) by_history[k] = by_history[k] + by_sigma[k];
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
};

/// Elastic constants of a material of the deck, doubles or dual numbers.
template <class Real = double>
struct ElasticModuli {
  Real bulk{}, shear{};  // Pa
  Real poisson_ratio() const { return (Real(3) * bulk - Real(2) * shear) / (Real(2) * (Real(3) * bulk + shear)); }
  Real lame() const { return bulk - Real(2) * shear / Real(3); }

  static ElasticModuli from_young(Real young, Real poisson) {
    return {young / (Real(3) * (Real(1) - Real(2) * poisson)), young / (Real(2) * (Real(1) + poisson))};
  }
};

template <class Material, class Number>
auto moduli_from_young(const Material& m, const Number& number) {
  return ElasticModuli<decltype(number(m.youngs_modulus))>::from_young(number(m.youngs_modulus), number(m.poisson_ratio));
}
template <class Number = DeckNumber>
auto elastic_moduli(const deck::LinearElastic& m, const Number& number = {}) {
  return moduli_from_young(m, number);
}
template <class Number = DeckNumber>
auto elastic_moduli(const deck::NeoHookean& m, const Number& number = {}) {
  return moduli_from_young(m, number);
}

/// A fluid: K = ρ0 c², no shear stiffness, so that its Poisson ratio is 1/2.
template <class Number = DeckNumber>
auto elastic_moduli(const deck::Newtonian& m, const Number& number = {}) {
  using Real = decltype(number(m.density));
  const Real c = number(m.sound_speed);
  return ElasticModuli<Real>{number(m.density) * c * c, Real(0)};
}

/// From the two constants that the deck gives (the reader has checked that there are exactly two).
template <class Number = DeckNumber>
auto elastic_moduli(const deck::DruckerPrager& m, const Number& number = {}) {
  using Real = decltype(number(m.density));
  using Moduli = ElasticModuli<Real>;
  if (!m.bulk_modulus) return Moduli::from_young(number(m.youngs_modulus.value()), number(m.poisson_ratio.value()));
  const Real bulk = number(*m.bulk_modulus);
  if (m.youngs_modulus) {
    const Real young = number(*m.youngs_modulus);
    return Moduli{bulk, Real(3) * bulk * young / (Real(9) * bulk - young)};
  }
  const Real poisson = number(m.poisson_ratio.value());
  return Moduli{bulk, Real(3) * bulk * (Real(1) - Real(2) * poisson) / (Real(2) * (Real(1) + poisson))};
}

template <class Number = DeckNumber>
auto elastic_moduli(const deck::Material& material, const Number& number = {}) {
  return std::visit([&](const auto& m) { return elastic_moduli(m, number); }, material);
}

}  // namespace jaxmpm
