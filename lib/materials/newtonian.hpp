#pragma once
// Weakly compressible Newtonian fluid (Du & He 2025, Eqs 19–20): p = c²(ρ − ρ0), s = 2μ dev d. The paper prints the increment Δd and its
// determinant where the rate d and the trace are meant: s = 2μ dev d and ρ ← ρ/(1 + tr Δd). Two laws, so that an inviscid fluid carries no
// history.
#include <array>
#include <limits>

#include "deck/deck.hpp"
#include "materials/material.hpp"

namespace jaxmpm {

/// The equation of state, shared by both laws; e = ρ/ρ0 − 1.
template <class Scalar>
struct WeaklyCompressible {
  Scalar density;              // ρ0, kg/m³
  Scalar sound_speed;          // c, m/s: at least ten times the largest velocity
  Scalar minimum_compression;  // e below which pressure, and the density with it, is cut: −limit/(ρ0 c²); −∞ without a tension limit

  static constexpr bool by_hand = true;

  template <class Number = DeckNumber>
  static WeaklyCompressible from(const deck::Newtonian& m, const Number& number = {}) {
    using Exact = decltype(number(m.density));
    const Exact density = number(m.density), c = number(m.sound_speed);
    const Exact least = m.tension_limit ? -number(*m.tension_limit) / (density * c * c) : Exact(-std::numeric_limits<double>::infinity());
    return {Scalar(density), Scalar(c), Scalar(least)};
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Real wave_speed(Real, const Real*) const {
    return Real(sound_speed);
  }

  /// ρ ∫ p/ρ² dρ = ρ0 c² ((1 + e) ln(1 + e) − e), J per m³ of current volume.
  template <class Real, int Dim>
  JAXMPM_INLINE Real energy(Real e, const Real*) const {
    return Real(bulk()) * (e * e - (Real(1) + e) * minus_log_one_plus(e));
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int plastic_strain_index() {
    return -1;
  }

 protected:
  JAXMPM_INLINE Scalar bulk() const { return density * sound_speed * sound_speed; }

  template <class Real, int Dim>
  JAXMPM_INLINE void advance(const Matrix<Real, Dim>& H, Real& compression) const {
    compression = max(compress(compression, trace(H)), Real(minimum_compression));
  }

  template <class Real, int Dim>
  JAXMPM_INLINE auto advance_adjoint(const Matrix<Real, Dim>& H, Real e, Real& by_compression, Matrix<Real, Dim>& by_H,
                                     Real* by_constants) const {
    const Real theta = trace(H), least = Real(minimum_compression);
    const Real free = compress(e, theta), by_free = select(free > least, by_compression, Real(0));
    by_constants[2] = by_constants[2] + (by_compression - by_free);
    by_compression = by_free;
    const Real by_theta = compress_adjoint(e, theta, by_compression);
    for (int k = 0; k < Dim * Dim; ++k) by_H.a[k] = Real(0);
    for (int k = 0; k < Dim; ++k) by_H(k, k) = by_theta;
    return at_kink(free, least);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void pressure_adjoint(Real e, const Symmetric<Real, Dim>& by_sigma, Real& by_compression, Real* by_constants) const {
    const Real by_pressure = -trace(by_sigma), c(sound_speed), rho(density);
    by_compression = by_compression + Real(bulk()) * by_pressure;
    by_constants[0] = by_constants[0] + c * c * e * by_pressure;
    by_constants[1] = by_constants[1] + Real(2) * rho * c * e * by_pressure;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void add_pressure(Real e, Symmetric<Real, Dim>& stress) const {
    const Real pressure = Real(bulk()) * e;
    for (int k = 0; k < 3; ++k) stress[k] = stress[k] - pressure;
  }
};

/// μ = 0.
template <class Scalar>
struct InviscidFluid : WeaklyCompressible<Scalar> {
  template <class Number = DeckNumber>
  static InviscidFluid from(const deck::Newtonian& m, const Number& number = {}) {
    return {WeaklyCompressible<Scalar>::from(m, number)};
  }
  template <class Law>
  static auto constants(Law& law) {
    return std::array{&law.density, &law.sound_speed, &law.minimum_compression};
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int history_size() {
    return 0;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Real update(const Matrix<Real, Dim>& H, Real, Real& compression, Real*) const {
    this->advance(H, compression);
    return Real(0);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> stress(Real compression, const Real*) const {
    Symmetric<Real, Dim> sigma{};
    this->add_pressure(compression, sigma);
    return sigma;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE auto update_adjoint(const Matrix<Real, Dim>& H, Real, Real compression, const Real*, Real& by_compression, Real*,
                                    Matrix<Real, Dim>& by_H, Real* by_constants) const {
    return this->advance_adjoint(H, compression, by_compression, by_H, by_constants);
  }
  template <class Real, int Dim>
  JAXMPM_INLINE void stress_adjoint(Real compression, const Real*, const Symmetric<Real, Dim>& by_sigma, Real& by_compression, Real*,
                                    Real* by_constants) const {
    this->pressure_adjoint(compression, by_sigma, by_compression, by_constants);
  }

  JAXMPM_INLINE Scalar diffusivity() const { return Scalar(0); }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>&, Real, Real*) const {}  // the pressure is in the compression
};

/// μ > 0; the history is the viscous stress of the last step.
template <class Scalar>
struct ViscousFluid : WeaklyCompressible<Scalar> {
  Scalar viscosity;  // μ, Pa s

  template <class Number = DeckNumber>
  static ViscousFluid from(const deck::Newtonian& m, const Number& number = {}) {
    return {WeaklyCompressible<Scalar>::from(m, number), Scalar(number(m.viscosity))};
  }
  template <class Law>
  static auto constants(Law& law) {
    return std::array{&law.density, &law.sound_speed, &law.minimum_compression, &law.viscosity};
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int history_size() {
    return Symmetric<Scalar, Dim>::size;
  }

  /// s = 2μ dev d with d = sym H/Δt; dissipates s : d Δt = s : s/(2μ) Δt.
  template <class Real, int Dim>
  JAXMPM_INLINE Real update(const Matrix<Real, Dim>& H, Real dt, Real& compression, Real* history) const {
    this->advance(H, compression);
    const Real per_strain = Real(2) * Real(viscosity) / dt;
    const Symmetric<Real, Dim> shape = deviator(symmetric_part(H));
    for (int k = 0; k < shape.size; ++k) history[k] = per_strain * shape[k];
    return Real(2) * per_strain * half_square(shape);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> stress(Real compression, const Real* history) const {
    Symmetric<Real, Dim> sigma = read_symmetric<Real, Dim>(history);
    this->add_pressure(compression, sigma);
    return sigma;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE auto update_adjoint(const Matrix<Real, Dim>& H, Real dt, Real compression, const Real*, Real& by_compression,
                                    Real* by_history, Matrix<Real, Dim>& by_H, Real* by_constants) const {
    const auto kink = this->advance_adjoint(H, compression, by_compression, by_H, by_constants);
    const Real per_strain = Real(2) * Real(viscosity) / dt;
    const Symmetric<Real, Dim> shape = deviator(symmetric_part(H));
    Symmetric<Real, Dim> by_shape;
    Real work = Real(0);
    for (int k = 0; k < shape.size; ++k) {
      work = work + shape[k] * by_history[k];
      by_shape[k] = per_strain * by_history[k];
      by_history[k] = Real(0);  // the stress of the step before is forgotten
    }
    by_constants[3] = by_constants[3] + Real(2) / dt * work;
    symmetric_part_adjoint(deviator_adjoint(by_shape), by_H);
    return kink;
  }
  template <class Real, int Dim>
  JAXMPM_INLINE void stress_adjoint(Real compression, const Real*, const Symmetric<Real, Dim>& by_sigma, Real& by_compression,
                                    Real* by_history, Real* by_constants) const {
    for (int k = 0; k < by_sigma.size; ++k) by_history[k] = by_history[k] + by_sigma[k];
    this->pressure_adjoint(compression, by_sigma, by_compression, by_constants);
  }

  /// 4μ/(3ρ0): the damping of a plane pressure wave, the fastest that 2μ dev d causes.
  JAXMPM_INLINE Scalar diffusivity() const { return Scalar(4.0 / 3.0) * viscosity / this->density; }

  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    write_symmetric(deviator(stress), history);
  }
};

}  // namespace jaxmpm
