#pragma once
// Losses with known minima, in place of a run.
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/error.hpp"
#include "inverse/loss_function.hpp"

namespace jaxmpm::testing {

/// Half the sum of squares of residuals given as a function, which may throw NumericsError. Exact Jacobian by the function `jacobian`, or
/// differences where there is none.
class LeastSquares : public LossFunction {
 public:
  using Residuals = std::function<std::vector<double>(const Variables&)>;
  using Jacobian = std::function<std::vector<std::vector<double>>(const Variables&)>;  // [residual][variable]
  LeastSquares(SearchSpace space, Residuals residuals, Jacobian jacobian)
      : space_(std::move(space)), residuals_(std::move(residuals)), jacobian_(std::move(jacobian)) {}

  const SearchSpace& space() const override { return space_; }
  double loss(const Variables& u) override {
    ++evaluations;
    double sum = 0;
    for (const double r : residuals_(u)) sum += r * r / 2;
    if (sum < best_loss) {
      best_loss = sum;
      best = u;
    }
    return sum;
  }
  Linearisation linearise(const Variables& u, const Variables& spacing) override {
    return about(u, jacobian_ ? jacobian_(u) : differences(u, spacing));
  }
  Sample gradient(const Variables& u) override {
    const Linearisation here = about(u, jacobian_(u));
    return {here.loss, here.gradient};
  }
  void renew_steps(const Variables&) override { ++renewals; }
  bool steps_vary() const override { return vary; }

  int evaluations = 0, renewals = 0;
  bool vary = false;
  Variables best;
  double best_loss = std::numeric_limits<double>::infinity();

 private:
  using Rows = std::vector<std::vector<double>>;  // [residual][variable]
  Linearisation about(const Variables& u, const Rows& j) {
    const double value = loss(u);
    const auto r = residuals_(u);
    Linearisation here{value, Variables(u.size(), 0.0), SquareMatrix(u.size()), r.size()};
    for (std::size_t m = 0; m < r.size(); ++m)
      for (std::size_t a = 0; a < u.size(); ++a) {
        here.gradient[a] += r[m] * j[m][a];
        for (std::size_t b = 0; b < u.size(); ++b) here.normal(a, b) += j[m][a] * j[m][b];
      }
    return here;
  }
  Rows differences(Variables u, const Variables& spacing) const {
    Rows rows(residuals_(u).size(), std::vector<double>(u.size()));
    for (std::size_t a = 0; a < u.size(); ++a) {
      const double middle = u[a];
      u[a] = middle + spacing[a];
      const auto above = residuals_(u);
      u[a] = middle - spacing[a];
      const auto below = residuals_(u);
      u[a] = middle;
      for (std::size_t m = 0; m < rows.size(); ++m) rows[m][a] = (above[m] - below[m]) / (2 * spacing[a]);
    }
    return rows;
  }
  SearchSpace space_;
  Residuals residuals_;
  Jacobian jacobian_;
};

constexpr double inf = std::numeric_limits<double>::infinity();

/// Rosenbrock's valley as residuals 10 (y − x²), 1 − x; minimum 0 at (1, 1).
inline LeastSquares rosenbrock(SearchSpace space) {
  return {std::move(space),
          [](const Variables& u) {
            return std::vector<double>{10 * (u[1] - u[0] * u[0]), 1 - u[0]};
          },
          [](const Variables& u) {
            return std::vector<std::vector<double>>{{-20 * u[0], 10}, {-1, 0}};
          }};
}

inline SearchSpace plane(double x, double y) { return {{x, y}, {-inf, -inf}, {inf, inf}, {1, 1}}; }

}  // namespace jaxmpm::testing
