#pragma once
// B-splines of one variable for the reference step, from their piecewise polynomials.
#include "core/scalar.hpp"
#include "deck/deck.hpp"

namespace jaxmpm {

/// Number of nodes along an axis with a weight that may differ from zero.
inline int spline_support(deck::Basis basis) { return basis == deck::Basis::linear ? 2 : basis == deck::Basis::quadratic ? 3 : 4; }

/// First of them for a particle at X (cells).
inline int spline_base(deck::Basis basis, double X) {
  if (basis == deck::Basis::linear) return static_cast<int>(std::floor(X));
  if (basis == deck::Basis::quadratic) return static_cast<int>(std::floor(X - 0.5));
  return static_cast<int>(std::floor(X)) - 1;
}

/// φ at distance ξ = X − i from node i, in cells.
template <class Scalar>
Scalar spline(deck::Basis basis, const Scalar& xi) {
  const Scalar a = abs(xi);
  switch (basis) {
    case deck::Basis::linear:
      return a < Scalar(1) ? Scalar(1) - a : Scalar(0);
    case deck::Basis::quadratic:
      if (a < Scalar(0.5)) return Scalar(0.75) - a * a;
      return a < Scalar(1.5) ? Scalar(0.5) * (Scalar(1.5) - a) * (Scalar(1.5) - a) : Scalar(0);
    case deck::Basis::cubic:
      break;
  }
  if (a < Scalar(1)) return Scalar(2.0 / 3.0) - a * a * (Scalar(1) - Scalar(0.5) * a);
  const Scalar b = Scalar(2) - a;
  return b > Scalar(0) ? b * b * b / Scalar(6) : Scalar(0);
}

/// dφ/dX at ξ, per cell; of the linear spline at a node, the derivative in the cell above it.
template <class Scalar>
Scalar spline_slope(deck::Basis basis, const Scalar& xi) {
  const Scalar a = abs(xi), sign = xi < Scalar(0) ? Scalar(-1) : Scalar(1);
  switch (basis) {
    case deck::Basis::linear:
      return xi >= Scalar(-1) && xi < Scalar(1) ? -sign : Scalar(0);
    case deck::Basis::quadratic:
      if (a < Scalar(0.5)) return Scalar(-2) * xi;
      return a < Scalar(1.5) ? sign * (a - Scalar(1.5)) : Scalar(0);
    case deck::Basis::cubic:
      break;
  }
  if (a < Scalar(1)) return xi * (Scalar(1.5) * a - Scalar(2));
  const Scalar b = Scalar(2) - a;
  return b > Scalar(0) ? Scalar(-0.5) * sign * b * b : Scalar(0);
}

}  // namespace jaxmpm
