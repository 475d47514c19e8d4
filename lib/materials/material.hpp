#pragma once
// The contract of a material. A material is a plain struct with two or three templated calls; it is evaluated with float, double, packs of lanes
// (core/pack.hpp) and dual numbers (core/dual.hpp), on host and device. So no branches on values: use select(condition, a, b), max(a, b), min(a, b), sqrt, log.
//
//   template <class Scalar>                       // scalar of the parameters: the step's precision, double or a dual number
//   struct SomeLaw {
//     Scalar density; …
//     /// Number of history values a particle carries for this law (stress first, where it is carried).
//     template <int Dim> static constexpr int history_size();
//     /// Advances the committed state by one step. H = Δt ∇v. `compression` is ρ/ρ0 − 1; `history` has history_size values, updated in place.
//     /// Returns the energy dissipated per unit of current volume during the step (plastic or viscous work), J/m³.
//     template <class Real, int Dim> Real update(const Matrix<Real, Dim>& H, Real dt, Real& compression, Real* history) const;
//     /// Cauchy stress of a committed state, Pa, tension positive.
//     template <class Real, int Dim> Symmetric<Real, Dim> stress(Real compression, const Real* history) const;
//     /// Speed of the fastest elastic wave in that state, m/s (time step).
//     template <class Real, int Dim> Real wave_speed(Real compression, const Real* history) const;
//     /// Kinematic viscosity-like rate for the viscous limit of the time step, m²/s (0 where none).
//     Scalar diffusivity() const;
//     /// Strain energy per unit of current volume, J/m³.
//     template <class Real, int Dim> Real energy(Real compression, const Real* history) const;
//     /// History of a particle that starts with a given Cauchy stress (initial_stress) and compression.
//     template <class Real, int Dim> void start(const Symmetric<Real, Dim>& stress, Real compression, Real* history) const;
//     static constexpr int plastic_strain_index<Dim>  // place of plastic strain in history, −1 where none
//   };
