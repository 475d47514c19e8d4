#pragma once
// Differences of second order along one variable: central ones, one-sided ones where a bound is in the way.
#include "inverse/objective.hpp"

namespace jaxmpm {

/// derivative ≈ Σ weight f(u + offset along the variable). An offset of 0 is f(u) itself.
struct Difference {
  std::vector<double> offset, weight;
};

/// With spacing `h`. Bounds and what the deck allows decide the side.
Difference difference(const Unknowns& unknowns, const Objective& objective, const Variables& u, std::size_t variable, double h);

}  // namespace jaxmpm
