#pragma once
// The contract of a material. A material is a plain struct with a few templated calls; it is evaluated with float, double, packs of lanes
// (core/pack.hpp) and dual numbers (core/dual.hpp), on host and device. So no branches on values: use select(condition, a, b), max(a, b),
// min(a, b), sqrt, log, called unqualified. A new material is one file, one line in registry.hpp and one test (docs/materials-howto.md).
//
//   template <class Scalar>                       // scalar of the parameters: the step's precision, double or a dual number
//   struct SomeLaw {
//     Scalar density; …
//     /// The law of a deck's material. `number` reads the deck's numbers: as they are, or as dual numbers to differentiate by one of them.
//     template <class Number = DeckNumber> static SomeLaw from(const deck::SomeMaterial& material, const Number& number = {});
//     /// Pointers to all parameters, in a fixed order: what the adjoint differentiates by.
//     template <class Law> static auto constants(Law& law);
//     /// Number of history values a particle carries for this law (stress first, where it is carried).
//     template <int Dim> static constexpr int history_size();
//     /// Place of the plastic strain in the history, −1 where the law has none.
//     template <int Dim> static constexpr int plastic_strain_index();
//     /// Advances the committed state by one step. H = Δt ∇v. `compression` is ρ/ρ0 − 1; `history` has history_size values, updated
//     /// in place. Returns the energy dissipated per unit of current volume during the step (plastic work where the law has a
//     /// plastic strain, else viscous work), J/m³.
//     template <class Real, int Dim> Real update(const Matrix<Real, Dim>& H, Real dt, Real& compression, Real* history) const;
//     /// Cauchy stress of a committed state, Pa, tension positive.
//     template <class Real, int Dim> Symmetric<Real, Dim> stress(Real compression, const Real* history) const;
//     /// Speed of the fastest elastic wave in that state, m/s (time step).
//     template <class Real, int Dim> Real wave_speed(Real compression, const Real* history) const;
//     /// Rate at which the law's viscosity spreads momentum, m²/s (0 where none): the viscous limit of the time step.
//     Scalar diffusivity() const;
//     /// Strain energy per unit of current volume, J/m³.
//     template <class Real, int Dim> Real energy(Real compression, const Real* history) const;
//     /// Optional, where `static constexpr bool by_hand = true`: adjoints of update() and stress(), from the state at the start.
//     /// Without them core/tape.hpp differentiates on the CPU, and a GPU has no gradients of the law. by_compression and by_history are
//     /// by the end values before and by the start values after; by_H is written, by_constants added to (order of constants()); the
//     /// result tells where a branch hangs on round-off. stress_adjoint() adds to all. Tests compare them with the tape.
//     template <class Real, int Dim> Condition update_adjoint(const Matrix<Real, Dim>& H, Real dt, Real compression, const Real* history,
//         Real& by_compression, Real* by_history, Matrix<Real, Dim>& by_H, Real* by_constants) const;
//     template <class Real, int Dim> void stress_adjoint(Real compression, const Real* history, const Symmetric<Real, Dim>& by_sigma,
//         Real& by_compression, Real* by_history, Real* by_constants) const;
//     /// History of a particle that starts with a given Cauchy stress (initial_stress) and compression.
//     template <class Real, int Dim> void start(const Symmetric<Real, Dim>& stress, Real compression, Real* history) const;
//   };
//
// Pieces that laws share follow.
#include "core/dual.hpp"
#include "core/scalar.hpp"
#include "core/tensor.hpp"

namespace jaxmpm {

/// Reads a number of the deck as it is.
struct DeckNumber {
  double operator()(const double& x) const { return x; }
};
/// Reads the numbers of the deck as dual numbers, with derivative 1 for the one at `by`.
struct DeckNumberBy {
  const double* by;
  Dual<double, 1> operator()(const double& x) const { return &x == by ? Dual<double, 1>::variable(x, 0) : Dual<double, 1>(x); }
};

/// A symmetric tensor kept in a particle's history, in the order of Symmetric.
template <class Real, int Dim>
JAXMPM_INLINE Symmetric<Real, Dim> read_symmetric(const Real* history) {
  Symmetric<Real, Dim> s;
  for (int k = 0; k < s.size; ++k) s[k] = history[k];
  return s;
}

template <class Real, int Dim>
JAXMPM_INLINE void write_symmetric(const Symmetric<Real, Dim>& s, Real* history) {
  for (int k = 0; k < s.size; ++k) history[k] = s[k];
}

template <class Real, int Dim>
JAXMPM_INLINE Real mean(const Symmetric<Real, Dim>& s) {
  return Real(1.0 / 3.0) * trace(s);
}

/// s − (tr s / 3) I; the third of the trace also in plane strain, where zz is a component like the others.
template <class Real, int Dim>
JAXMPM_INLINE Symmetric<Real, Dim> deviator(const Symmetric<Real, Dim>& s) {
  const Real m = mean(s);
  Symmetric<Real, Dim> d = s;
  for (int k = 0; k < 3; ++k) d[k] = d[k] - m;
  return d;
}

/// s : s / 2; of a deviatoric stress, the invariant J2.
template <class Real, int Dim>
JAXMPM_INLINE Real half_square(const Symmetric<Real, Dim>& s) {
  Real shear = s[3] * s[3];
  if constexpr (Dim == 3) shear = shear + s[4] * s[4] + s[5] * s[5];
  return Real(0.5) * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + shear;
}

/// ρ ← ρ / (1 + θ) in terms of e = ρ/ρ0 − 1, θ the relative change of volume: no difference of large numbers, so that single precision
/// keeps e.
template <class Real>
JAXMPM_INLINE Real compress(Real e, Real theta) {
  return (e - theta) / (Real(1) + theta);
}

/// Adjoint of compress(): `by` is by its result, then by e; returns the derivative by θ.
template <class Real>
JAXMPM_INLINE Real compress_adjoint(Real e, Real theta, Real& by) {
  const Real inverse = Real(1) / (Real(1) + theta);
  by = by * inverse;
  return -by * (Real(1) + e) * inverse;
}

/// Adjoint of deviator(): its own transpose, as the zz component is one like the others.
template <class Real, int Dim>
JAXMPM_INLINE Symmetric<Real, Dim> deviator_adjoint(const Symmetric<Real, Dim>& by) {
  return deviator(by);
}

/// Adjoint of symmetric_part(): adds to the derivatives by the matrix.
template <class Real, int Dim>
JAXMPM_INLINE void symmetric_part_adjoint(const Symmetric<Real, Dim>& by, Matrix<Real, Dim>& by_m) {
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) by_m(i, j) = by_m(i, j) + (i == j ? Real(1) : Real(0.5)) * by[Symmetric<Real, Dim>::index(i, j)];
}

/// Adjoint of half_square(): Σ by · ∂/∂s.
template <class Real, int Dim>
JAXMPM_INLINE void half_square_adjoint(const Symmetric<Real, Dim>& s, Real by, Symmetric<Real, Dim>& by_s) {
  for (int k = 0; k < s.size; ++k) by_s[k] = by_s[k] + (k < 3 ? Real(1) : Real(2)) * by * s[k];
}

/// x − log(1 + x) = x²/2 − x³/3 + … without cancellation: by its series below |x| = 0.03, where nine terms leave less than 1e-14.
template <class Real>
JAXMPM_INLINE Real minus_log_one_plus(Real x) {
  Real series = Real(0);
  for (int n = 10; n >= 2; --n) series = Real(1.0 / n) - x * series;
  return select(abs(x) < Real(0.03), x * x * series, x - log1p(x));
}

}  // namespace jaxmpm
