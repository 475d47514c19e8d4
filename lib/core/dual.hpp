#pragma once
// Forward-mode dual numbers: a value with N directional derivatives, so that any templated function also gives its Jacobian times N
// vectors.
#include <type_traits>

#include "core/scalar.hpp"

namespace jaxmpm {

/// value + Σ_k derivative[k] ε_k with ε_j ε_k = 0. Comparisons, and so select(), max() and min(), look at the value: a branch is
/// differentiated as taken. T may itself be a dual number (second derivatives).
template <class T, int N>
struct Dual {
  T value{};
  T derivative[N]{};

  Dual() = default;
  /// A constant: derivatives zero.
  template <class A, class = std::enable_if_t<std::is_arithmetic_v<A> || std::is_same_v<A, T>>>
  JAXMPM_INLINE Dual(const A& constant) : value(constant) {}  // implicit, so that constants mix with dual numbers
  /// The independent variable number k: derivative 1 along k.
  static JAXMPM_INLINE Dual variable(const T& value, int k) {
    Dual x(value);
    x.derivative[k] = T(1);
    return x;
  }

  JAXMPM_INLINE Dual operator-() const { return chain(-value, T(-1), *this); }
  JAXMPM_INLINE Dual& operator+=(const Dual& b) { return *this = *this + b; }
  JAXMPM_INLINE Dual& operator-=(const Dual& b) { return *this = *this - b; }
  JAXMPM_INLINE Dual& operator*=(const Dual& b) { return *this = *this * b; }
  JAXMPM_INLINE Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend JAXMPM_INLINE Dual operator+(const Dual& a, const Dual& b) { return chain(a.value + b.value, T(1), a, T(1), b); }
  friend JAXMPM_INLINE Dual operator-(const Dual& a, const Dual& b) { return chain(a.value - b.value, T(1), a, T(-1), b); }
  friend JAXMPM_INLINE Dual operator*(const Dual& a, const Dual& b) { return chain(a.value * b.value, b.value, a, a.value, b); }
  friend JAXMPM_INLINE Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return chain(quotient, T(1) / b.value, a, -quotient / b.value, b);
  }

  friend JAXMPM_INLINE bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend JAXMPM_INLINE bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend JAXMPM_INLINE bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend JAXMPM_INLINE bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend JAXMPM_INLINE bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend JAXMPM_INLINE bool operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  friend JAXMPM_INLINE Dual select(bool condition, const Dual& a, const Dual& b) { return condition ? a : b; }
  friend JAXMPM_INLINE Dual max(const Dual& a, const Dual& b) { return a < b ? b : a; }
  friend JAXMPM_INLINE Dual min(const Dual& a, const Dual& b) { return b < a ? b : a; }
  friend JAXMPM_INLINE Dual abs(const Dual& a) { return a.value < T(0) ? -a : a; }
  friend JAXMPM_INLINE Dual sqrt(const Dual& a) {
    const T root = sqrt(a.value);
    return chain(root, T(0.5) / root, a);
  }
  friend JAXMPM_INLINE Dual exp(const Dual& a) {
    const T e = exp(a.value);
    return chain(e, e, a);
  }
  friend JAXMPM_INLINE Dual log(const Dual& a) { return chain(log(a.value), T(1) / a.value, a); }
  friend JAXMPM_INLINE Dual log1p(const Dual& a) { return chain(log1p(a.value), T(1) / (T(1) + a.value), a); }
  friend JAXMPM_INLINE Dual expm1(const Dual& a) { return chain(expm1(a.value), exp(a.value), a); }
  friend JAXMPM_INLINE Dual sin(const Dual& a) { return chain(sin(a.value), cos(a.value), a); }
  friend JAXMPM_INLINE Dual cos(const Dual& a) { return chain(cos(a.value), -sin(a.value), a); }
  friend JAXMPM_INLINE auto value_of(const Dual& a) { return value_of(a.value); }

 private:
  /// f(a) or f(a, b) with partial derivatives fa and fb.
  static JAXMPM_INLINE Dual chain(const T& f, const T& fa, const Dual& a) {
    Dual r(f);
    for (int k = 0; k < N; ++k) r.derivative[k] = fa * a.derivative[k];
    return r;
  }
  static JAXMPM_INLINE Dual chain(const T& f, const T& fa, const Dual& a, const T& fb, const Dual& b) {
    Dual r(f);
    for (int k = 0; k < N; ++k) r.derivative[k] = fa * a.derivative[k] + fb * b.derivative[k];
    return r;
  }
};

}  // namespace jaxmpm
