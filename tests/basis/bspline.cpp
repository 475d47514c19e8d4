// B-splines: what every basis has to fulfil, and their derivatives against dual numbers.
#include "basis/bspline.hpp"

#include <catch2/catch.hpp>

#include "basis/spline_in_cell.hpp"
#include "core/dual.hpp"
#include "core/pack.hpp"

using namespace jaxmpm;

namespace {

/// Offsets f = X − base that a particle can have, over the whole cell and at its ends.
template <int S>
std::vector<double> offsets() {
  std::vector<double> all;
  for (int k = 0; k <= 16; ++k) all.push_back(Bspline<S>::base_shift + k / 16.0 * (1 - 1e-12));
  return all;
}

template <int S>
void check_moments() {
  for (const double f : offsets<S>()) {
    double w[S], g[S], sum = 0, first = 0, second = 0, slope_sum = 0, slope_first = 0;
    Bspline<S>::weights(f, w), Bspline<S>::slopes(f, g);
    for (int i = 0; i < S; ++i) {
      CHECK(w[i] >= -1e-15);
      sum += w[i], first += w[i] * (i - f), second += w[i] * (i - f) * (i - f);
      slope_sum += g[i], slope_first += g[i] * (i - f);
    }
    INFO(S << " nodes, offset " << f);
    CHECK(sum == Approx(1).epsilon(1e-14));
    CHECK(first == Approx(0).margin(1e-14));
    if (S > 2) CHECK(second == Approx(Bspline<S>::second_moment).epsilon(1e-13));
    CHECK(slope_sum == Approx(0).margin(1e-14));
    CHECK(slope_first == Approx(1).epsilon(1e-13));
  }
}

template <int S>
void check_derivatives() {
  using Inner = Dual<double, 1>;
  using Outer = Dual<Inner, 1>;
  for (const double f : offsets<S>()) {
    Outer w[S];
    double g[S], k[S];
    Bspline<S>::weights(Outer::variable(Inner::variable(f, 0), 0), w);
    Bspline<S>::slopes(f, g), Bspline<S>::curvatures(f, k);
    for (int i = 0; i < S; ++i) {
      INFO(S << " nodes, node " << i << ", offset " << f);
      CHECK(g[i] == Approx(w[i].value.derivative[0]).margin(1e-14));
      CHECK(k[i] == Approx(w[i].derivative[0].derivative[0]).margin(1e-14));
    }
  }
}

/// Σ over the nodes of a factor × some values, against the polynomial of those values.
template <int S>
void check_polynomials() {
  const double all[] = {0.7, -1.3, 2.1, 0.4};
  double n[S], c[S];
  for (int i = 0; i < S; ++i) n[i] = all[i];
  spline_coefficients(n, c);
  for (const double f : offsets<S>()) {
    double w[S], g[S], k[S], value = 0, slope = 0, curvature = 0, moment = 0, moment_slope = 0;
    Bspline<S>::weights(f, w), Bspline<S>::slopes(f, g), Bspline<S>::curvatures(f, k);
    for (int i = 0; i < S; ++i) {
      value += w[i] * n[i], slope += g[i] * n[i], curvature += k[i] * n[i];
      moment += w[i] * (i - f) * n[i], moment_slope += (g[i] * (i - f) - w[i]) * n[i];
    }
    const SplinePlace<S, double> place(f);
    SplineAt<double> at{};
    static_for<S>([&](auto order) { place.template add<order>(at, c[order]); });
    INFO(S << " nodes, offset " << f);
    CHECK(at.value == Approx(value).margin(1e-14));
    CHECK(at.slope == Approx(slope).margin(1e-14));
    CHECK(at.curvature == Approx(curvature).margin(1e-14));
    CHECK(at.highest == Approx(S == 2 ? n[1] - n[0] : S == 3 ? n[0] - 2 * n[1] + n[2] : n[3] - n[0] - 3 * (n[2] - n[1])));
    CHECK(place.of_slope * at.slope + place.of_highest * at.highest == Approx(moment).margin(1e-14));
    CHECK(place.of_slope * at.curvature + place.of_highest_slope * at.highest == Approx(moment_slope).margin(1e-14));
  }
}

}  // namespace

TEST_CASE("splines sum to one and reproduce positions, and their second moment is the same everywhere") {
  check_moments<2>();
  check_moments<3>();
  check_moments<4>();
}

TEST_CASE("slopes and curvatures of splines are the derivatives of their weights") {
  check_derivatives<2>();
  check_derivatives<3>();
  check_derivatives<4>();
}

TEST_CASE("splines of the smooth bases go on from cell to cell") {
  double left[4], right[4];
  Bspline<3>::weights(1.5, left), Bspline<3>::weights(0.5, right);  // a particle at the end of a cell, and at the start of the next
  CHECK(left[0] == Approx(0).margin(1e-15));
  for (int i = 0; i < 2; ++i) CHECK(left[i + 1] == Approx(right[i]).margin(1e-15));
  Bspline<4>::weights(2.0, left), Bspline<4>::weights(1.0, right);
  CHECK(left[0] == Approx(0).margin(1e-15));
  for (int i = 0; i < 3; ++i) CHECK(left[i + 1] == Approx(right[i]).margin(1e-15));
}

TEST_CASE("in a cell a spline is a polynomial, and moments follow from its derivatives") {
  check_polynomials<2>();
  check_polynomials<3>();
  check_polynomials<4>();
}
