#pragma once
// The scalar functions that numerical templates call unqualified: here for float and double; core/dual.hpp and core/pack.hpp overload the
// same names for dual numbers and packs of lanes. A comparison gives bool (or a mask of lanes); select() takes it, so that one source
// serves all.
#include <cmath>

#include "core/macros.hpp"

namespace jaxmpm {

JAXMPM_INLINE float select(bool condition, float a, float b) { return condition ? a : b; }
JAXMPM_INLINE double select(bool condition, double a, double b) { return condition ? a : b; }

/// Larger and smaller of two numbers. A NaN in the first argument comes through, so that a run that went bad is noticed.
JAXMPM_INLINE float max(float a, float b) { return a < b ? b : a; }
JAXMPM_INLINE double max(double a, double b) { return a < b ? b : a; }
JAXMPM_INLINE float min(float a, float b) { return b < a ? b : a; }
JAXMPM_INLINE double min(double a, double b) { return b < a ? b : a; }

JAXMPM_INLINE float abs(float x) { return std::fabs(x); }
JAXMPM_INLINE double abs(double x) { return std::fabs(x); }
JAXMPM_INLINE float sqrt(float x) { return std::sqrt(x); }
JAXMPM_INLINE double sqrt(double x) { return std::sqrt(x); }
JAXMPM_INLINE float exp(float x) { return std::exp(x); }
JAXMPM_INLINE double exp(double x) { return std::exp(x); }
JAXMPM_INLINE float log(float x) { return std::log(x); }
JAXMPM_INLINE double log(double x) { return std::log(x); }
JAXMPM_INLINE float sin(float x) { return std::sin(x); }
JAXMPM_INLINE double sin(double x) { return std::sin(x); }
JAXMPM_INLINE float cos(float x) { return std::cos(x); }
JAXMPM_INLINE double cos(double x) { return std::cos(x); }
JAXMPM_INLINE float expm1(float x) { return std::expm1(x); }
JAXMPM_INLINE double expm1(double x) { return std::expm1(x); }
JAXMPM_INLINE float log1p(float x) { return std::log1p(x); }
JAXMPM_INLINE double log1p(double x) { return std::log1p(x); }

/// The number itself, without derivatives: for decisions such as which cell a particle is in.
JAXMPM_INLINE float value_of(float x) { return x; }
JAXMPM_INLINE double value_of(double x) { return x; }

/// Whether a branch that compares two numbers hangs on the round-off of double precision; infinite ones never do.
template <class Real>
JAXMPM_INLINE auto at_kink(const Real& a, const Real& b) {
  const Real distance = abs(a - b);
  return (distance <= Real(1e-12) * max(abs(a), abs(b))) & (distance < Real(1e30));
}

/// at_kink() of a law that does not branch.
template <class Real>
JAXMPM_INLINE auto no_kink() {
  return Real(0) > Real(1);
}

}  // namespace jaxmpm
