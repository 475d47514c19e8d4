#pragma once
// Compressible neo-Hookean solid: ψ = μ/2 (tr b − 3) − μ ln J + λ/2 (ln J)² per unit of initial volume, so
// σ = (μ (b − I) + λ ln J I)/J. The state is A = F − I, and b − I, J − 1 and ln J are formed from A
// without differences of large numbers, so that single precision resolves small strains. In 2D F_zz = 1 (plane strain).
#include "materials/elastic.hpp"

namespace jaxmpm {

/// det(I + A) − 1 − tr A: sum of the principal 2×2 minors and, in space, the determinant.
template <class Real, int Dim>
JAXMPM_INLINE Real volume_change_beyond_trace(const Matrix<Real, Dim>& A) {
  Real rest = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  if constexpr (Dim == 3) {
    const Real yz = A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1);
    rest = rest + yz + (A(0, 0) * A(2, 2) - A(0, 2) * A(2, 0)) + A(0, 0) * yz - A(0, 1) * (A(1, 0) * A(2, 2) - A(1, 2) * A(2, 0)) +
           A(0, 2) * (A(1, 0) * A(2, 1) - A(1, 1) * A(2, 0));
  }
  return rest;
}

/// det(I + A) − 1.
template <class Real, int Dim>
JAXMPM_INLINE Real volume_change(const Matrix<Real, Dim>& A) {
  return trace(A) + volume_change_beyond_trace(A);
}

/// Adjoint of volume_change(): adds `by` times the cofactors of I + A.
template <class Real, int Dim>
JAXMPM_INLINE void volume_change_adjoint(const Matrix<Real, Dim>& A, Real by, Matrix<Real, Dim>& by_A) {
  Matrix<Real, Dim> F = A;
  for (int k = 0; k < Dim; ++k) F(k, k) = Real(1) + F(k, k);
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      Real cofactor;
      if constexpr (Dim == 2) {
        cofactor = i == j ? F(1 - i, 1 - j) : -F(1 - i, 1 - j);
      } else {
        const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
        cofactor = F(k, m) * F(l, n) - F(k, n) * F(l, m);
      }
      by_A(i, j) = by_A(i, j) + by * cofactor;
    }
}

template <class Scalar>
struct NeoHookean {
  Scalar density;      // ρ0, kg/m³
  Scalar lame, shear;  // λ and μ, Pa

  static constexpr bool by_hand = true;

  template <class Number = DeckNumber>
  static NeoHookean from(const deck::NeoHookean& m, const Number& number = {}) {
    const auto moduli = elastic_moduli(m, number);
    return {Scalar(number(m.density)), Scalar(moduli.lame()), Scalar(moduli.shear)};
  }
  template <class Law>
  static auto constants(Law& law) {
    return std::array{&law.density, &law.lame, &law.shear};
  }

  template <int Dim>
  static constexpr JAXMPM_INLINE int history_size() {
    return Dim * Dim;
  }
  template <int Dim>
  static constexpr JAXMPM_INLINE int plastic_strain_index() {
    return -1;
  }

  /// F ← (I + H) F.
  template <class Real, int Dim>
  JAXMPM_INLINE Real update(const Matrix<Real, Dim>& H, Real, Real& compression, Real* history) const {
    compression = compress(compression, volume_change(H));
    const Matrix<Real, Dim> A = read<Real, Dim>(history);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        Real sum = H(i, j);
        for (int k = 0; k < Dim; ++k) sum = sum + H(i, k) * A(k, j);
        history[i * Dim + j] = A(i, j) + sum;
      }
    return Real(0);
  }

  template <class Real, int Dim>
  JAXMPM_INLINE auto update_adjoint(const Matrix<Real, Dim>& H, Real, Real compression, const Real* history, Real& by_compression,
                                    Real* by_history, Matrix<Real, Dim>& by_H, Real*) const {
    const Matrix<Real, Dim> A = read<Real, Dim>(history), by = read<Real, Dim>(by_history);
    for (int i = 0; i < Dim; ++i)
      for (int k = 0; k < Dim; ++k) {
        by_H(i, k) = by(i, k);
        Real sum = by(i, k);
        for (int j = 0; j < Dim; ++j) {
          by_H(i, k) = by_H(i, k) + by(i, j) * A(k, j);
          sum = sum + H(j, i) * by(j, k);
        }
        by_history[i * Dim + k] = sum;
      }
    volume_change_adjoint(H, compress_adjoint(compression, volume_change(H), by_compression), by_H);
    return no_kink<Real>();
  }

  template <class Real, int Dim>
  JAXMPM_INLINE Symmetric<Real, Dim> stress(Real, const Real* history) const {
    const Matrix<Real, Dim> A = read<Real, Dim>(history);
    const Real growth = volume_change(A);
    const Real spherical = Real(lame) * log1p(growth);
    const Real per_volume = Real(1) / (Real(1) + growth);
    Symmetric<Real, Dim> sigma = stretch<Real, Dim>(A);
    for (int k = 0; k < sigma.size; ++k) sigma[k] = per_volume * Real(shear) * sigma[k];
    for (int k = 0; k < 3; ++k) sigma[k] = sigma[k] + per_volume * spherical;
    return sigma;
  }

  template <class Real, int Dim>
  JAXMPM_INLINE void stress_adjoint(Real, const Real* history, const Symmetric<Real, Dim>& by_sigma, Real&, Real* by_history,
                                    Real* by_constants) const {
    const Matrix<Real, Dim> A = read<Real, Dim>(history);
    const Symmetric<Real, Dim> b = stretch<Real, Dim>(A);
    const Real growth = volume_change(A), log_J = log1p(growth), per_volume = Real(1) / (Real(1) + growth);
    const Real mu(shear), lambda(lame), by_pressure = trace(by_sigma);
    Real by_stretch = Real(0);
    for (int k = 0; k < b.size; ++k) by_stretch = by_stretch + by_sigma[k] * b[k];
    by_constants[1] = by_constants[1] + per_volume * log_J * by_pressure;
    by_constants[2] = by_constants[2] + per_volume * by_stretch;
    Matrix<Real, Dim> by_A;
    for (int k = 0; k < Dim * Dim; ++k) by_A.a[k] = Real(0);
    const Real by_per_volume = mu * by_stretch + lambda * log_J * by_pressure;
    volume_change_adjoint(A, per_volume * per_volume * (lambda * by_pressure - by_per_volume), by_A);
    for (int i = 0; i < Dim; ++i)  // adjoint of stretch()
      for (int j = 0; j <= i; ++j) {
        const Real by = per_volume * mu * by_sigma[Symmetric<Real, Dim>::index(i, j)];
        by_A(i, j) = by_A(i, j) + by, by_A(j, i) = by_A(j, i) + by;
        for (int k = 0; k < Dim; ++k) by_A(i, k) = by_A(i, k) + by * A(j, k), by_A(j, k) = by_A(j, k) + by * A(i, k);
      }
    for (int k = 0; k < Dim * Dim; ++k) by_history[k] = by_history[k] + by_A.a[k];
  }

  /// A pressure wave along a principal stretch Λ has ρ0 c² = μ (Λ² + 1) + λ (1 − ln J); Λ² is bounded by 1 + |b − I|.
  template <class Real, int Dim>
  JAXMPM_INLINE Real wave_speed(Real, const Real* history) const {
    const Matrix<Real, Dim> A = read<Real, Dim>(history);
    const Real size = sqrt(Real(2) * half_square(stretch<Real, Dim>(A)));
    const Real bulk_part = Real(lame) * max(Real(1) - log1p(volume_change(A)), Real(0));
    return sqrt((Real(shear) * (Real(2) + size) + bulk_part) / Real(density));
  }

  JAXMPM_INLINE Scalar diffusivity() const { return Scalar(0); }

  /// ψ/J, with (tr b − 3)/2 − ln J = A:A/2 − (J − 1 − tr A) + (J − 1 − ln J), each term of second order in A.
  template <class Real, int Dim>
  JAXMPM_INLINE Real energy(Real, const Real* history) const {
    const Matrix<Real, Dim> A = read<Real, Dim>(history);
    Real square = Real(0);
    for (int k = 0; k < Dim * Dim; ++k) square = square + A.a[k] * A.a[k];
    const Real growth = volume_change(A), log_J = log1p(growth);
    const Real isochoric = Real(0.5) * square - volume_change_beyond_trace(A) + minus_log_one_plus(growth);
    return (Real(shear) * isochoric + Real(0.5) * Real(lame) * log_J * log_J) / (Real(1) + growth);
  }

  /// The symmetric F whose stress is the given one; in 2D σ_zz follows from the other components. J solves det b = J² with
  /// b = I + (J σ − λ ln J I)/μ, by a fixed number of chord steps from the linear solution; stresses up to about a third of μ converge.
  template <class Real, int Dim>
  JAXMPM_INLINE void start(const Symmetric<Real, Dim>& stress, Real, Real* history) const {
    constexpr int steps = 60;
    const Real mu(shear), lambda(lame);
    const Real chord = Real(1) / (Real(1) + Real(0.5 * Dim) * lambda / mu);
    Matrix<Real, Dim> B{};
    Real log_J = Real(0);
    for (int step = 0; step < steps; ++step) {
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          B(i, j) = exp(log_J) * stress(i, j) / mu;
          if (i == j) B(i, j) = B(i, j) - lambda * log_J / mu;
        }
      log_J = log_J + chord * (Real(0.5) * log1p(volume_change(B)) - log_J);
    }
    Matrix<Real, Dim> A{};
    for (int step = 0; step < steps; ++step) {  // A = (B − A²)/2, the square root of I + B
      Matrix<Real, Dim> next;
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          Real sum = B(i, j);
          for (int k = 0; k < Dim; ++k) sum = sum - A(i, k) * A(k, j);
          next(i, j) = Real(0.5) * sum;
        }
      A = next;
    }
    for (int k = 0; k < Dim * Dim; ++k) history[k] = A.a[k];
  }

 private:
  template <class Real, int Dim>
  static JAXMPM_INLINE Matrix<Real, Dim> read(const Real* history) {
    Matrix<Real, Dim> A;
    for (int k = 0; k < Dim * Dim; ++k) A.a[k] = history[k];
    return A;
  }

  /// b − I = A + Aᵀ + A Aᵀ; its zz is zero in plane strain.
  template <class Real, int Dim>
  static JAXMPM_INLINE Symmetric<Real, Dim> stretch(const Matrix<Real, Dim>& A) {
    Symmetric<Real, Dim> b{};
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j <= i; ++j) {
        Real sum = A(i, j) + A(j, i);
        for (int k = 0; k < Dim; ++k) sum = sum + A(i, k) * A(j, k);
        b[Symmetric<Real, Dim>::index(i, j)] = sum;
      }
    return b;
  }
};

}  // namespace jaxmpm
