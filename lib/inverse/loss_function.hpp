#pragma once
// The loss as optimisers see it: a function of the variables.
#include "inverse/linear_algebra.hpp"
#include "inverse/search_space.hpp"

namespace jaxmpm {

/// Least spacing of the Jacobian's differences in parts of the variable's scale: the error of the difference, of the order of its square,
/// and that of rounding in a run, some 1e-12 over it, are both far below what a standard error or a Gauss–Newton step needs.
constexpr double least_jacobian_spacing = 1e-4;

/// Least squares about a point: residuals r and their Jacobian J by the variables.
struct Linearisation {
  double loss = 0;
  Variables gradient;         // Jᵀr
  SquareMatrix normal;        // JᵀJ
  std::size_t residuals = 0;  // that are not masked
};

/// Every evaluation throws NumericsError when the run becomes unstable.
class LossFunction {
 public:
  struct Sample {
    double loss;
    Variables gradient;
  };
  virtual ~LossFunction() = default;
  virtual const SearchSpace& space() const = 0;
  virtual Sample gradient(const Variables& u) = 0;
  virtual double loss(const Variables& u) = 0;
  /// With differences over `spacing` of each variable.
  virtual Linearisation linearise(const Variables& u, const Variables& spacing) = 0;
  /// Later evaluations take the steps that a run with these variables chooses.
  virtual void renew_steps(const Variables& u) = 0;
  /// Whether the steps depend on the variables, so that renewing them changes the function.
  virtual bool steps_vary() const = 0;
};

}  // namespace jaxmpm
