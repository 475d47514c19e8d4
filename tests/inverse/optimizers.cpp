// Optimisers on losses whose minimum is known, with bounds, bad scales and places where a run becomes unstable.
#include <catch2/catch.hpp>

#include "functions.hpp"
#include "inverse/optimizer.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

TEST_CASE("L-BFGS finds the end of Rosenbrock's valley") {
  LeastSquares valley = rosenbrock(plane(-1.2, 1));
  CHECK(minimise(deck::Lbfgs{100, 10, {}}, valley) == Ending::converged);
  CHECK(valley.best[0] == Approx(1).epsilon(1e-6));
  CHECK(valley.best[1] == Approx(1).epsilon(1e-6));
  CHECK(valley.evaluations <= 80);
}

TEST_CASE("Gauss-Newton finds the end of Rosenbrock's valley in few steps") {
  LeastSquares valley = rosenbrock(plane(-1.2, 1));
  CHECK(minimise(deck::GaussNewton{0.05, 50, {}}, valley) == Ending::converged);
  CHECK(valley.best_loss < 1e-20);
  CHECK(valley.evaluations <= 80);
}

TEST_CASE("Gauss-Newton does not jump to where the data say nothing") {
  // x² is to be 0.09. Beyond 0.5 it can no more be seen: better than the start at 0.05, and level. The first step would lead to 0.92.
  LeastSquares hidden(
      {{0.05}, {0}, {1}, {1}}, [](const Variables& u) { return std::vector<double>{(u[0] < 0.5 ? u[0] * u[0] : 0.12) - 0.09}; },
      [](const Variables& u) { return std::vector<std::vector<double>>{{u[0] < 0.5 ? 2 * u[0] : 0}}; });
  minimise(deck::GaussNewton{0.05, 30, {}}, hidden);
  CHECK(hidden.best[0] == Approx(0.3));
}

TEST_CASE("Gauss-Newton crosses a loss that is rough on close scales") {
  // Ten readings that grow with u, each with ripples of its own whose slopes are twenty times the trend's.
  const auto residuals = [](const Variables& u) {
    std::vector<double> r;
    for (int m = 1; m <= 10; ++m) r.push_back(0.1 * m * (u[0] - 0.7) + 0.01 * std::sin(200 * u[0] * (1 + 0.1 * m) + m));
    return r;
  };
  for (const double start : {0.05, 0.3, 0.95}) {
    LeastSquares rough({{start}, {0}, {1}, {1}}, residuals, {}), close = rough;
    minimise(deck::GaussNewton{0.05, 20, {}}, rough);
    CHECK(rough.best[0] == Approx(0.7).margin(0.01));
    CHECK(rough.evaluations < 60);
    minimise(deck::GaussNewton{1e-4, 20, {}}, close);
    CHECK(std::abs(close.best[0] - 0.7) > 0.01);  // stopped by the next ripple
  }
}

TEST_CASE("Gauss-Newton takes closer differences where a run beside becomes unstable") {
  LeastSquares edge({{0.98}, {0}, {1}, {1}},
                    [](const Variables& u) {
                      if (u[0] > 0.99) throw NumericsError("unstable");
                      return std::vector<double>{u[0] * u[0] - 0.25};
                    },
                    {});
  CHECK(minimise(deck::GaussNewton{0.05, 20, {}}, edge) == Ending::converged);
  CHECK(edge.best[0] == Approx(0.5));
}

TEST_CASE("Adam comes down a bowl and stops within its tolerance of what cannot be explained") {
  LeastSquares bowl(
      {{3, -2}, {-inf, -inf}, {inf, inf}, {1, 1}},
      [](const Variables& u) {
        return std::vector<double>{u[0] - 1, 3 * (u[1] - 0.5), 0.1};
      },
      [](const Variables&) {
        return std::vector<std::vector<double>>{{1, 0}, {0, 3}, {0, 0}};
      });
  CHECK(minimise(deck::Adam{0.2, 0.98, 300, 1e-3}, bowl) == Ending::converged);
  CHECK(bowl.best[0] == Approx(1).margin(0.01));
  CHECK(bowl.best[1] == Approx(0.5).margin(0.01));
  CHECK(bowl.evaluations < 200);
}

TEST_CASE("Adam's first steps are the learning rate times its decay") {
  LeastSquares slope(
      {{0}, {-inf}, {inf}, {1}}, [](const Variables& u) { return std::vector<double>{std::sqrt(2 * (100 - u[0]))}; },
      [](const Variables& u) {
        return std::vector<std::vector<double>>{{-1 / std::sqrt(2 * (100 - u[0]))}};  // gradient −1 everywhere
      });
  CHECK(minimise(deck::Adam{0.1, 0.5, 4, {}}, slope) == Ending::iterations);
  CHECK(slope.evaluations == 4);
  CHECK(slope.best[0] == Approx(0.1 * (1 + 0.5 + 0.25)).epsilon(1e-6));
}

TEST_CASE("Optimisers keep to the bounds and find a minimum that lies on them") {
  // Unbounded minimum (2, −1); within [0,1]² it is (1, 0.1): u₁ = (−1 + 2.2)/… see the condition ∂/∂u₁ = 0 at u₀ = 1.
  const auto residuals = [](const Variables& u) {
    for (const double x : u)
      if (x < 0 || x > 1) throw std::logic_error("outside of the bounds");
    return std::vector<double>{u[0] + u[1] - 1, u[0] - 2, u[1] - 0.2};
  };
  const auto jacobian = [](const Variables&) { return std::vector<std::vector<double>>{{1, 1}, {1, 0}, {0, 1}}; };
  // At u₀ = 1: (u₁) + (u₁ − 0.2) = 0 gives u₁ = 0.1; ∂/∂u₀ = 0.1 − 1 < 0 pushes against the bound.
  const SearchSpace square{{0.3, 0.9}, {0, 0}, {1, 1}, {1, 1}};
  for (const deck::Optimizer& optimizer : {deck::Optimizer(deck::Adam{0.1, 0.98, 400, {}}), deck::Optimizer(deck::Lbfgs{100, 10, {}}),
                                           deck::Optimizer(deck::GaussNewton{0.05, 50, {}})}) {
    LeastSquares corner(square, residuals, jacobian);
    minimise(optimizer, corner);
    INFO("optimizer " << optimizer.index());
    CHECK(corner.best[0] == 1);
    CHECK(corner.best[1] == Approx(0.1).margin(1e-4));
  }
}

TEST_CASE("A run that becomes unstable shortens the step instead of ending the search") {
  int refused = 0;
  const auto residuals = [&refused](const Variables& u) {
    if (u[0] > 1.05) {
      ++refused;
      throw NumericsError("unstable");
    }
    return std::vector<double>{1e3 * (u[0] - 1), u[0] * u[0] - 1};
  };
  const auto jacobian = [](const Variables& u) { return std::vector<std::vector<double>>{{1e3}, {2 * u[0]}}; };
  for (const deck::Optimizer& optimizer : {deck::Optimizer(deck::Adam{5, 0.98, 200, {}}), deck::Optimizer(deck::Lbfgs{60, 10, {}})}) {
    LeastSquares cliff({{0.2}, {-inf}, {inf}, {20}}, residuals, jacobian);
    refused = 0;
    minimise(optimizer, cliff);
    INFO("optimizer " << optimizer.index());
    CHECK(refused > 0);
    CHECK(cliff.best[0] == Approx(1).margin(2e-3));
  }
  // Gauss–Newton's first step leads just beyond: 1.3 from x² = 4.
  LeastSquares root(
      {{1}, {-inf}, {inf}, {1}},
      [&](const Variables& u) {
        if (u[0] > 2.2) throw NumericsError("unstable");
        return std::vector<double>{u[0] * u[0] - 4};
      },
      [](const Variables& u) { return std::vector<std::vector<double>>{{2 * u[0]}}; });
  minimise(deck::GaussNewton{0.05, 30, {}}, root);
  CHECK(root.best[0] == Approx(2));
}

TEST_CASE("A start from which the run is unstable is an error") {
  for (const deck::Optimizer& optimizer :
       {deck::Optimizer(deck::Adam{}), deck::Optimizer(deck::Lbfgs{}), deck::Optimizer(deck::GaussNewton{})}) {
    LeastSquares nowhere(
        plane(0, 0), [](const Variables&) -> std::vector<double> { throw NumericsError("unstable"); },
        [](const Variables&) { return std::vector<std::vector<double>>{}; });
    CHECK_THROWS_AS(minimise(optimizer, nowhere), NumericsError);
  }
}

TEST_CASE("Badly scaled losses do not throw L-BFGS off") {
  for (const double size : {1e-12, 1e12}) {
    LeastSquares bowl(
        {{0.1}, {0}, {5}, {5}}, [size](const Variables& u) { return std::vector<double>{size * (u[0] - 2)}; },
        [size](const Variables&) { return std::vector<std::vector<double>>{{size}}; });
    CHECK(minimise(deck::Lbfgs{30, 10, {}}, bowl) == Ending::converged);
    CHECK(bowl.best[0] == Approx(2).epsilon(1e-7));
    CHECK(bowl.evaluations <= 12);
  }
}

TEST_CASE("L-BFGS ends where the loss only goes up and down by rounding") {
  // As a run in single precision: what it reads jumps by 1e-7 of itself, while its gradient is exact.
  LeastSquares grainy(
      {{0.1}, {0}, {5}, {5}}, [](const Variables& u) { return std::vector<double>{1e-7 * std::sin(1e9 * u[0]) + u[0] - 2}; },
      [](const Variables&) { return std::vector<std::vector<double>>{{1}}; });
  CHECK(minimise(deck::Lbfgs{200, 10, {}}, grainy) != Ending::iterations);
  CHECK(grainy.best[0] == Approx(2).margin(1e-6));
  CHECK(grainy.evaluations <= 30);
}

TEST_CASE("L-BFGS goes on after unknowns that the data say much about to those they say little about") {
  // As friction near the far end of a flow: at the start its derivative is some 1e-9 of the others'.
  const Variables truth{0.5, 0.2}, weight{1e3, 1e-2};
  LeastSquares bowl(
      {{0, 0}, {0, 0}, {1, 1}, {1, 1}},
      [&](const Variables& u) {
        return std::vector<double>{weight[0] * (u[0] - truth[0]), weight[1] * (u[1] - truth[1])};
      },
      [&](const Variables&) {
        return std::vector<std::vector<double>>{{weight[0], 0}, {0, weight[1]}};
      });
  CHECK(minimise(deck::Lbfgs{60, 10, {}}, bowl) == Ending::converged);
  CHECK(bowl.best[0] == Approx(truth[0]).epsilon(1e-6));
  CHECK(bowl.best[1] == Approx(truth[1]).epsilon(1e-3));
}

TEST_CASE("Where steps vary L-BFGS renews them between its legs and ends when that changes nothing") {
  LeastSquares valley = rosenbrock(plane(-1.2, 1));
  valley.vary = true;
  CHECK(minimise(deck::Lbfgs{300, 10, {}}, valley) == Ending::converged);
  CHECK(valley.renewals > 2);
  CHECK(valley.best[0] == Approx(1).epsilon(1e-5));
  LeastSquares few = rosenbrock(plane(-1.2, 1));
  few.vary = true;
  CHECK(minimise(deck::Lbfgs{25, 10, {}}, few) == Ending::iterations);
  CHECK(few.evaluations == 25);
}

TEST_CASE("Normal equations: solution, inverse, and what has none") {
  SquareMatrix a(2);
  a.entries = {4e6, 1e3, 1e3, 1};  // scaled: [1 0.5; 0.5 1]
  const auto x = solve(a, {4e6 + 2e3, 1e3 + 2});
  REQUIRE(x);
  CHECK((*x)[0] == Approx(1));
  CHECK((*x)[1] == Approx(2));
  const auto diagonal = inverse_diagonal(a);
  REQUIRE(diagonal);
  CHECK((*diagonal)[0] == Approx(1 / 3e6));  // entry / determinant: 1/(4e6 − 1e6)
  CHECK((*diagonal)[1] == Approx(4.0 / 3));
  a.entries = {1, 1, 1, 1};
  CHECK_FALSE(solve(a, {1, 1}));
  a.entries = {1, 0, 0, 0};
  CHECK_FALSE(inverse_diagonal(a));
}
