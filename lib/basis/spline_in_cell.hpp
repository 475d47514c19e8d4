#pragma once
// A B-spline of one axis as a polynomial: where particles share a base node, along one cell's length, what values at the S nodes spline to
// is of degree S − 1. Places are t ∈ [−½, ½] cells from the middle of that stretch.
#include "basis/bspline.hpp"

namespace jaxmpm {

/// The coefficients of values n at the nodes: the spline and its derivatives in the middle, so that Σ w n = c_0 + t c_1 + t²/2 c_2 + t³/6 c_3.
template <int S, class Real>
JAXMPM_INLINE void spline_coefficients(const Real (&n)[S], Real (&c)[S]) {
  if constexpr (S == 2) {
    c[0] = Real(0.5) * (n[0] + n[1]), c[1] = n[1] - n[0];
  } else if constexpr (S == 3) {
    const Real ends = n[0] + n[2];
    c[0] = Real(0.125) * ends + Real(0.75) * n[1], c[1] = Real(0.5) * (n[2] - n[0]), c[2] = ends - Real(2) * n[1];
  } else {
    const Real outer = n[0] + n[3], inner = n[1] + n[2], across = n[3] - n[0], between = n[2] - n[1];
    c[0] = Real(1.0 / 48) * outer + Real(23.0 / 48) * inner, c[1] = Real(0.125) * across + Real(0.625) * between;
    c[2] = Real(0.5) * (outer - inner), c[3] = across - Real(3) * between;
  }
}

/// What values at the nodes spline to at a place: Σ w n, Σ g n, Σ g' n, and the derivative of the highest order that there is, S − 1.
template <class Real>
struct SplineAt {
  Real value, slope, curvature, highest;
};

/// A place, at offset f from the base node.
///
/// Moments follow from derivatives: with q = ¼ − t², Σ d n = q Σ g n for linear splines, ¼ Σ g n + t q/2 Σ g' n for quadratic and
/// ⅓ Σ g n − q²/6 Σ g'' n for cubic ones (found by putting powers of X_i − X for n: Σ w (X_i − X)^k is known for B-splines).
template <int S, class Real>
struct SplinePlace {
  Real power[S];                      // t^k / k!
  Real of_highest, of_highest_slope;  // factor of the highest derivative in a moment, and its derivative by t
  static constexpr double of_slope = S == 2 ? 0 : Bspline<S>::second_moment;  // of the slope; linear splines' is the highest derivative

  SplinePlace() = default;
  JAXMPM_INLINE explicit SplinePlace(Real f) {
    const Real t = f - Real(0.5 * (S - 1)), q = Real(0.25) - t * t;
    power[0] = Real(1);
    for (int k = 1; k < S; ++k) power[k] = Real(1.0 / k) * t * power[k - 1];
    if constexpr (S == 2) of_highest = q, of_highest_slope = Real(-2) * t;
    else if constexpr (S == 3) of_highest = Real(0.5) * t * q, of_highest_slope = Real(0.5) * q - t * t;
    else of_highest = Real(-1.0 / 6) * q * q, of_highest_slope = Real(2.0 / 3) * t * q;
  }
  /// Adds what coefficient k brings; 0 comes first, S − 1 last.
  template <int k>
  JAXMPM_INLINE void add(SplineAt<Real>& sum, Real c) const {
    sum.value = k == 0 ? c : sum.value + power[k] * c;
    if constexpr (k >= 1) sum.slope = k == 1 ? c : sum.slope + power[k - 1] * c;
    if constexpr (k >= 2) sum.curvature = k == 2 ? c : sum.curvature + power[k - 2] * c;
    else if constexpr (S == 2) sum.curvature = Real(0);
    if constexpr (k == S - 1) sum.highest = c;
  }
};

}  // namespace jaxmpm
