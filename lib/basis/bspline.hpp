#pragma once
// B-splines of one axis on the unit lattice (Eq 5 and its linear and cubic siblings; de Boor). X is in cells.
#include <type_traits>

#include "core/macros.hpp"
#include "deck/deck.hpp"

namespace jaxmpm {

/// Spline reaching S nodes: 2 linear, 3 quadratic, 4 cubic. A particle at X has base node floor(X − base_shift) and offset f = X − base.
template <int S>
struct Bspline {
  static_assert(S >= 2 && S <= 4);
  static constexpr double base_shift = S == 2 ? 0.0 : (S == 3 ? 0.5 : 1.0);
  /// Second moment D of the basis in cells², the same everywhere in the cell (not for linear splines).
  static constexpr double second_moment = S == 3 ? 0.25 : 1.0 / 3;

  template <class Real>
  static JAXMPM_INLINE void weights(Real f, Real w[S]) {
    if constexpr (S == 2) {
      w[0] = Real(1) - f, w[1] = f;
    } else if constexpr (S == 3) {
      const Real l = Real(1.5) - f, c = f - Real(1), r = f - Real(0.5);
      w[0] = Real(0.5) * l * l, w[1] = Real(0.75) - c * c, w[2] = Real(0.5) * r * r;
    } else {
      const Real u = f - Real(1), o = Real(1) - u, sixth = Real(1.0 / 6);  // u in [0, 1)
      w[0] = sixth * o * o * o, w[3] = sixth * u * u * u;
      w[1] = Real(2.0 / 3) - u * u * (Real(1) - Real(0.5) * u), w[2] = Real(2.0 / 3) - o * o * (Real(1) - Real(0.5) * o);
    }
  }
  /// dφ/dX, per cell.
  template <class Real>
  static JAXMPM_INLINE void slopes(Real f, Real g[S]) {
    if constexpr (S == 2) {
      g[0] = Real(-1), g[1] = Real(1);
    } else if constexpr (S == 3) {
      g[0] = f - Real(1.5), g[1] = Real(-2) * (f - Real(1)), g[2] = f - Real(0.5);
    } else {
      const Real u = f - Real(1), o = Real(1) - u;
      g[0] = Real(-0.5) * o * o, g[3] = Real(0.5) * u * u;
      g[1] = u * (Real(1.5) * u - Real(2)), g[2] = o * (Real(2) - Real(1.5) * o);
    }
  }
  /// d²φ/dX², per cell².
  template <class Real>
  static JAXMPM_INLINE void curvatures(Real f, Real k[S]) {
    if constexpr (S == 2) {
      k[0] = Real(0), k[1] = Real(0);
    } else if constexpr (S == 3) {
      k[0] = Real(1), k[1] = Real(-2), k[2] = Real(1);
    } else {
      const Real u = f - Real(1), o = Real(1) - u;
      k[0] = o, k[1] = Real(3) * u - Real(2), k[2] = Real(3) * o - Real(2), k[3] = u;
    }
  }
};

/// Calls f(integral_constant S) with the number of nodes that a basis reaches.
template <class F>
auto with_spline(deck::Basis basis, F&& f) {
  switch (basis) {
    case deck::Basis::linear:
      return f(std::integral_constant<int, 2>{});
    case deck::Basis::quadratic:
      return f(std::integral_constant<int, 3>{});
    case deck::Basis::cubic:
      break;
  }
  return f(std::integral_constant<int, 4>{});
}

}  // namespace jaxmpm
