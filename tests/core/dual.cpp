// Dual numbers against closed forms of their derivatives.
#include "core/dual.hpp"
#include "core/pack.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm {
namespace {

using D2 = Dual<double, 2>;

TEST_CASE("dual numbers carry both partial derivatives through arithmetic") {
  const double x0 = 1.7, y0 = -0.6;
  const D2 x = D2::variable(x0, 0), y = D2::variable(y0, 1);
  const D2 f = (x * y - 3) / (x + 2 * y * y);  // integers mix in as constants
  const double denominator = x0 + 2 * y0 * y0, value = (x0 * y0 - 3) / denominator;
  CHECK(f.value == Approx(value).epsilon(1e-15));
  CHECK(f.derivative[0] == Approx((y0 - value) / denominator).epsilon(1e-14));
  CHECK(f.derivative[1] == Approx((x0 - value * 4 * y0) / denominator).epsilon(1e-14));

  D2 g = x;
  g += y;
  g *= y;
  g -= x;
  g /= x;  // ((x + y) y − x)/x = y + y²/x − 1
  CHECK(g.value == Approx(y0 + y0 * y0 / x0 - 1).epsilon(1e-15));
  CHECK(g.derivative[0] == Approx(-y0 * y0 / (x0 * x0)).epsilon(1e-14));
  CHECK(g.derivative[1] == Approx(1 + 2 * y0 / x0).epsilon(1e-14));
}

TEST_CASE("dual numbers know the derivatives of the elementary functions") {
  const double x0 = 0.37;
  const D2 x = D2::variable(x0, 0);
  CHECK(sqrt(x).derivative[0] == Approx(0.5 / std::sqrt(x0)).epsilon(1e-15));
  CHECK(exp(x).derivative[0] == Approx(std::exp(x0)).epsilon(1e-15));
  CHECK(log(x).derivative[0] == Approx(1 / x0).epsilon(1e-15));
  CHECK(log1p(x).derivative[0] == Approx(1 / (1 + x0)).epsilon(1e-15));
  CHECK(abs(-x).derivative[0] == 1);
  CHECK((-x).derivative[0] == -1);
}

TEST_CASE("dual numbers choose by value and differentiate the branch taken") {
  const D2 x = D2::variable(2, 0), y = D2::variable(3, 1);
  CHECK(max(x, y).derivative[1] == 1);
  CHECK(min(x, y).derivative[0] == 1);
  CHECK(select(x < y, x, y).derivative[0] == 1);
  CHECK(select(x > y, x, y).derivative[1] == 1);
  CHECK((x <= y && y >= x && x != y && !(x == y)));
  CHECK(value_of(x * y) == 6);
}

TEST_CASE("dual numbers of dual numbers give second derivatives") {
  using Inner = Dual<double, 1>;
  using Outer = Dual<Inner, 1>;
  const double x0 = 0.8;
  const Outer x = Outer::variable(Inner::variable(x0, 0), 0);
  const Outer f = exp(x) * sqrt(x);
  const double root = std::sqrt(x0);
  CHECK(f.derivative[0].derivative[0] == Approx(std::exp(x0) * (root + 1 / root - 0.25 / (root * x0))).epsilon(1e-14));
  CHECK(value_of(f) == Approx(std::exp(x0) * root).epsilon(1e-15));
}

TEST_CASE("a NaN in the first argument comes through max and min") {
  const double nan = std::nan("");
  CHECK(std::isnan(max(nan, 1.0)));
  CHECK(std::isnan(min(nan, 1.0)));
  CHECK(std::isnan(max(std::nanf(""), 1.0f)));
  CHECK(std::isnan(min(std::nanf(""), 1.0f)));
  using P = Pack<double, 2>;
  CHECK(std::isnan(max(P(nan), P(1.0))[1]));
  CHECK(std::isnan(min(P(nan), P(1.0))[1]));
  using D = Dual<double, 1>;
  CHECK(std::isnan(value_of(max(D(nan), D(1.0)))));
  CHECK(std::isnan(value_of(min(D(nan), D(1.0)))));
}

}  // namespace
}  // namespace jaxmpm
