#pragma once
// Small fixed-size tensors over any scalar: float, double, a pack of lanes (core/pack.hpp) or a dual number (core/dual.hpp).
#include "core/macros.hpp"

namespace jaxmpm {

template <class Real, int Dim>
struct Vector {
  Real a[Dim];
  JAXMPM_INLINE Real& operator[](int i) { return a[i]; }
  JAXMPM_INLINE const Real& operator[](int i) const { return a[i]; }
};

/// Row-major; of a velocity gradient, (i, j) is ∂v_i/∂x_j.
template <class Real, int Dim>
struct Matrix {
  Real a[Dim * Dim];
  JAXMPM_INLINE Real& operator()(int i, int j) { return a[i * Dim + j]; }
  JAXMPM_INLINE const Real& operator()(int i, int j) const { return a[i * Dim + j]; }
};

/// Symmetric tensor in plane strain (2D: xx, yy, zz, xy) or in space (3D: xx, yy, zz, xy, yz, xz).
template <class Real, int Dim>
struct Symmetric {
  static constexpr int size = Dim == 2 ? 4 : 6;
  Real a[size];
  JAXMPM_INLINE Real& operator[](int k) { return a[k]; }
  JAXMPM_INLINE const Real& operator[](int k) const { return a[k]; }
  /// Index in storage of component (i, j), i and j below Dim.
  static constexpr JAXMPM_INLINE int index(int i, int j) { return i == j ? i : (i + j == 1 ? 3 : (i + j == 3 ? 4 : 5)); }
  JAXMPM_INLINE const Real& operator()(int i, int j) const { return a[index(i, j)]; }
};

template <class Real, int Dim>
JAXMPM_INLINE Real trace(const Matrix<Real, Dim>& m) {
  Real t = m(0, 0) + m(1, 1);
  if constexpr (Dim == 3) t = t + m(2, 2);
  return t;
}

template <class Real, int Dim>
JAXMPM_INLINE Real trace(const Symmetric<Real, Dim>& s) {
  return s[0] + s[1] + s[2];
}

/// Symmetric part of a matrix; its zz is zero in plane strain.
template <class Real, int Dim>
JAXMPM_INLINE Symmetric<Real, Dim> symmetric_part(const Matrix<Real, Dim>& m) {
  if constexpr (Dim == 2) return {{m(0, 0), m(1, 1), Real(0), Real(0.5) * (m(0, 1) + m(1, 0))}};
  else
    return {{m(0, 0), m(1, 1), m(2, 2), Real(0.5) * (m(0, 1) + m(1, 0)), Real(0.5) * (m(1, 2) + m(2, 1)), Real(0.5) * (m(0, 2) + m(2, 0))}};
}

}  // namespace jaxmpm
