#pragma once
// Drucker–Prager elastoplasticity with a tension cut-off, non-associated (Du & He 2025, appendix A), with three repairs (docs/theory.md):
// the rotation is exact (elastic.hpp); a return that would leave the admissible region ends at the corner of cone and cut-off; and for
// strong dilation the border of the tension zone follows the return direction, so that the stress is continuous in the trial stress.
#include <cmath>

#include "materials/elastic.hpp"

namespace jaxmpm {

template <class Scalar>
struct DruckerPrager : RateElastic<Scalar> {
  Scalar friction;        // q_φ = 6 sin φ / (√3 (3 + sin φ))
  Scalar cohesion;        // k_φ = 6 c cos φ / (√3 (3 + sin φ)), Pa
  Scalar dilation;        // q_ψ = 6 sin ψ / (√3 (3 + sin ψ))
  Scalar tension_cutoff;  // σᵗ, Pa, at most k_φ/q_φ (the apex)

  template <class Number = DeckNumber>
  static DruckerPrager from(const deck::DruckerPrager& m, const Number& number = {}) {
    using Exact = decltype(number(m.density));
    const auto moduli = elastic_moduli(m, number);
    const Exact degree(std::acos(-1.0) / 180), root3(std::sqrt(3.0)), three(3), six(6);
    const Exact sin_phi = sin(number(m.friction_angle) * degree), cos_phi = cos(number(m.friction_angle) * degree);
    const Exact sin_psi = sin(number(m.dilation_angle) * degree);
    return {{Scalar(number(m.density)), {Scalar(moduli.bulk), Scalar(moduli.shear)}},
            Scalar(six * sin_phi / (root3 * (three + sin_phi))),
            Scalar(six * number(m.cohesion) * cos_phi / (root3 * (three + sin_phi))),
            Scalar(six * sin_psi / (root3 * (three + sin_psi))),
            Scalar(number(m.tension_cutoff))};
  }
  template <class Law>
  static auto constants(Law& law) {
    return std::array{&law.density,  &law.elasticity.bulk, &law.elasticity.shear, &law.friction,
                      &law.cohesion, &law.dilation,        &law.tension_cutoff};
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int history_size() {
    return Symmetric<Scalar, Dim>::size + 1;
  }
  template <int Dim>
  static constexpr JAXMPM_INLINE int plastic_strain_index() {
    return Symmetric<Scalar, Dim>::size;
  }

  /// A state of the meridian plane on or inside the yield surface, and the plastic strain that took it there.
  template <class Real>
  struct Returned {
    Real mean, shear;     // σ_m and τ, Pa
    Real plastic_strain;  // Δε_eq,p
    Real opening;         // volume strain that the tension cut-off took, ≥ 0
  };

  /// Slope of the border between shear and tensile failure, from the corner (σᵗ, τ^P) into the trial states above the cut-off:
  /// α^P of Eq A.8, or the return direction (K q_ψ, G) where that lies below it.
  JAXMPM_INLINE Scalar border_slope() const {
    const Scalar alpha = sqrt(Scalar(1) + friction * friction) - friction;
    const Scalar sideways = this->elasticity.bulk * dilation;
    return select(alpha * sideways > this->elasticity.shear, this->elasticity.shear / sideways, alpha);
  }

  /// Returns a trial state to the surface (Eqs A.5–A.19).
  template <class Real>
  JAXMPM_INLINE Returned<Real> return_to_surface(Real trial_mean, Real trial_shear) const {
    const Real q(friction), k(cohesion), cutoff(tension_cutoff), bulk(this->elasticity.bulk), G(this->elasticity.shear);
    const Real fs = trial_shear - k + q * trial_mean;                                              // A.5
    const Real ft = trial_mean - cutoff;                                                           // A.6
    const Real h = trial_shear - (k - q * cutoff) - Real(border_slope()) * ft;                     // A.7
    const Real outside = select(ft < Real(0), fs, h);                                              // zone II where positive, A.10
    const Real sideways = bulk * Real(dilation);                                                   // K q_ψ
    const Real lambda_s = select(outside > Real(0), fs / (G + sideways * q), Real(0));             // A.16
    const Real lambda_t = select(ft < Real(0), Real(0), select(h > Real(0), Real(0), ft / bulk));  // zone III, A.11 and A.19
    Returned<Real> end;
    const Real sheared_mean = trial_mean - sideways * lambda_s;  // A.12
    end.mean = min(sheared_mean, cutoff);                        // A.17 and the corner
    end.opening = (sheared_mean - end.mean) / bulk;
    // One clamp is A.13 in zone II, the corner where that was passed, and what keeps zone III below the cone (A.17 keeps τ).
    end.shear = max(min(trial_shear, k - q * end.mean), Real(0));
    end.plastic_strain = lambda_s * Real(shear_strain_factor()) + Real(0.47140452079103168) * lambda_t;  // A.15 and A.18 (√2/3)
    return end;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Real update(const Matrix<Real, Dim>& H, Real, Real& compression, Real* history) const {
    Symmetric<Real, Dim> sigma = this->elasticity.trial_stress(read_symmetric<Real, Dim>(history), H);
    const Real trial_mean = mean(sigma);
    sigma = deviator(sigma);
    // The floor (1e-18 Pa) keeps τ^{n+1}/τ and the derivative of the root finite where there is no shear.
    const Real trial_shear = sqrt(max(half_square(sigma), Real(1e-36)));  // A.4
    const Returned<Real> end = return_to_surface(trial_mean, trial_shear);
    // What the cut-off takes off the mean stress is a gap that opens, no growth of the grains' volume: without this, grains that fly apart
    // swell without bound, stiffen (K V/m) and shorten the time step. As a fluid's tension limit does, the density is cut with the
    // pressure.
    compression = compress(compression, trace(H) - end.opening);
    const Real scale = end.shear / trial_shear;
    for (int k = 0; k < sigma.size; ++k) sigma[k] = scale * sigma[k];  // A.14
    for (int k = 0; k < 3; ++k) sigma[k] = sigma[k] + end.mean;
    write_symmetric(sigma, history);
    history[sigma.size] = history[sigma.size] + end.plastic_strain;
    // σ : Δε^p with Δε^p = C⁻¹ : (σ_trial − σ).
    return end.shear * (trial_shear - end.shear) / Real(this->elasticity.shear) +
           end.mean * (trial_mean - end.mean) / Real(this->elasticity.bulk);
  }

  /// Adjoint of return_to_surface(): in `by` the derivatives by its result; adds those by the constants (order of constants()); returns
  /// those by the trial state in by_mean and by_shear.
  template <class Real>
  JAXMPM_INLINE auto return_adjoint(Real trial_mean, Real trial_shear, Returned<Real> by, Real& by_mean, Real& by_shear,
                                    Real* by_constants) const {
    const Real q(friction), k(cohesion), psi(dilation), cutoff(tension_cutoff), bulk(this->elasticity.bulk), G(this->elasticity.shear);
    const Real zero(0);
    // The forward values once more.
    const Real fs = trial_shear - k + q * trial_mean, ft = trial_mean - cutoff;
    const Real h = trial_shear - (k - q * cutoff) - Real(border_slope()) * ft;
    const Real sideways = bulk * psi, stiffness = G + sideways * q;
    const auto below = ft < zero;
    const auto sheared = select(below, fs, h) > zero;
    const Real lambda_s = select(sheared, fs / stiffness, zero);
    const Real lambda_t = select(below, zero, select(h > zero, zero, ft / bulk));
    const Real sheared_mean = trial_mean - sideways * lambda_s, mean = min(sheared_mean, cutoff), top = k - q * mean;
    const Real factor(shear_strain_factor()), opening = (sheared_mean - mean) / bulk;
    Real by_q = zero, by_k = zero, by_psi = zero, by_cutoff = zero, by_bulk = zero, by_G = zero, by_sideways = zero;
    // Plastic strain, shear with its clamps, opening and mean.
    Real by_lambda_s = by.plastic_strain * factor;
    const Real by_lambda_t = by.plastic_strain * Real(0.47140452079103168);
    by_psi = by_psi + by.plastic_strain * lambda_s * Real(2.0 / 9.0) * psi / factor;
    const Real by_limited = select(min(trial_shear, top) > zero, by.shear, zero);
    const Real by_top = select(trial_shear < top, zero, by_limited);
    by_shear = by_limited - by_top;
    by_k = by_k + by_top, by_q = by_q - mean * by_top;
    const Real by_opening = by.opening / bulk;
    const Real by_end_mean = by.mean - q * by_top - by_opening;
    by_bulk = by_bulk - by_opening * opening;
    const Real by_free = select(sheared_mean < cutoff, by_end_mean, zero);
    by_cutoff = by_cutoff + (by_end_mean - by_free);
    const Real by_sheared = by_free + by_opening;
    by_mean = by_sheared;
    by_lambda_s = by_lambda_s - sideways * by_sheared, by_sideways = by_sideways - lambda_s * by_sheared;
    // λ^t = f^t/K in zone III, λ^s = f^s/(G + K q_ψ q_φ) in zone II.
    const Real by_ft = select(below, zero, select(h > zero, zero, by_lambda_t / bulk));
    by_mean = by_mean + by_ft, by_cutoff = by_cutoff - by_ft, by_bulk = by_bulk - by_ft * lambda_t;
    const Real by_fs = select(sheared, by_lambda_s / stiffness, zero), by_stiffness = -by_fs * lambda_s;
    by_shear = by_shear + by_fs, by_mean = by_mean + q * by_fs;
    by_k = by_k - by_fs, by_q = by_q + trial_mean * by_fs + sideways * by_stiffness;
    by_G = by_G + by_stiffness, by_sideways = by_sideways + q * by_stiffness;
    by_psi = by_psi + bulk * by_sideways, by_bulk = by_bulk + psi * by_sideways;
    const Real all[] = {by_bulk, by_G, by_q, by_k, by_psi, by_cutoff};
    for (int c = 0; c < 6; ++c) by_constants[1 + c] = by_constants[1 + c] + all[c];
    return at_kink(trial_shear, k - q * trial_mean) | at_kink(trial_mean, cutoff) | at_kink(sheared_mean, cutoff) | at_kink(h, zero);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE auto update_adjoint(const Matrix<Real, Dim>& H, Real, Real compression, const Real* history, Real& by_compression,
                                    Real* by_history, Matrix<Real, Dim>& by_H, Real* by_constants) const {
    const Symmetric<Real, Dim> start = read_symmetric<Real, Dim>(history);
    const Symmetric<Real, Dim> trial = this->elasticity.trial_stress(start, H), shape = deviator(trial);
    const Real trial_mean = mean(trial), square = half_square(shape), floor(1e-36);
    const Real trial_shear = sqrt(max(square, floor));
    const Returned<Real> end = return_to_surface(trial_mean, trial_shear);
    const Real scale = end.shear / trial_shear, theta = trace(H) - end.opening;

    const Symmetric<Real, Dim> by_end = read_symmetric<Real, Dim>(by_history);
    const Real by_theta = compress_adjoint(compression, theta, by_compression);
    Real by_scale(0);
    for (int k = 0; k < shape.size; ++k) by_scale = by_scale + by_end[k] * shape[k];
    Real by_trial_mean, by_trial_shear;
    const auto kink =
        return_adjoint(trial_mean, trial_shear, Returned<Real>{trace(by_end), by_scale / trial_shear, by_history[shape.size], -by_theta},
                       by_trial_mean, by_trial_shear, by_constants);
    by_trial_shear = by_trial_shear - by_scale * scale / trial_shear;
    Symmetric<Real, Dim> by_shape;
    for (int k = 0; k < shape.size; ++k) by_shape[k] = scale * by_end[k];
    half_square_adjoint(shape, select(square > floor, Real(0.5) * by_trial_shear / trial_shear, Real(0)), by_shape);
    Symmetric<Real, Dim> by = deviator_adjoint(by_shape);
    for (int k = 0; k < 3; ++k) by[k] = by[k] + Real(1.0 / 3.0) * by_trial_mean;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) by_H(i, j) = i == j ? by_theta : Real(0);
    this->elasticity.trial_stress_adjoint(start, H, by, by_H, by_constants[1], by_constants[2]);
    write_symmetric(by, by_history);  // the plastic strain's own derivative passes through
    return kink;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    write_symmetric(stress, history);
    history[stress.size] = Real(0);
  }

 private:
  JAXMPM_INLINE Scalar shear_strain_factor() const { return sqrt(Scalar(1.0 / 3.0) + Scalar(2.0 / 9.0) * dilation * dilation); }  // A.15
};

}  // namespace jaxmpm
