// Obstacles at one node against the laws in closed form, and their adjoint against differences.
#include "contact/obstacles.hpp"

#include <catch2/catch.hpp>

#include "contact/wall_adjoint.hpp"

using namespace jaxmpm;

namespace {

using V = Vector<double, 3>;
using Kind = deck::ContactKind;

const V normal{0.6, 0, 0.8};  // out of the solid
constexpr double mass = 2, friction = 0.3;

/// Velocity with a part vn along the normal and (1, 2, −0.75) along the surface.
V with_approach(double vn) { return {1 + vn * normal[0], 2, -0.75 + vn * normal[2]}; }

V after(Kind kind, V v, double mu = friction) {
  apply_obstacle<double, 3>(kind, mu, normal, mass, v);
  return v;
}

}  // namespace

TEST_CASE("an obstacle takes from the velocity what its law says") {
  const V towards = with_approach(-1), away = with_approach(1), along = with_approach(0);
  const double speed = std::sqrt(1 + 4 + 0.5625);
  for (int c = 0; c < 3; ++c) {
    CHECK(after(Kind::slip, towards)[c] == Approx(along[c]));
    CHECK(after(Kind::slip, away)[c] == Approx(along[c]));  // it holds on both ways
    CHECK(after(Kind::no_slip, towards)[c] == 0);
    CHECK(after(Kind::separate, towards)[c] == Approx(along[c]));
    CHECK(after(Kind::separate, away)[c] == away[c]);
    CHECK(after(Kind::friction, away)[c] == away[c]);
    CHECK(after(Kind::friction, towards)[c] == Approx(along[c] * (1 - friction / speed)));  // Coulomb: μ times the normal impulse
    CHECK(after(Kind::friction, towards, 3)[c] == Approx(0).margin(1e-15));                 // sticks
  }
}

TEST_CASE("an obstacle's impulse is the change of momentum, and its friction work that of energy along the surface") {
  const V before = with_approach(-1);
  V v = before;
  const ObstacleContact<double, 3> done = apply_obstacle<double, 3>(Kind::friction, friction, normal, mass, v);
  double lost = 0;
  const V along = with_approach(0);
  for (int c = 0; c < 3; ++c) {
    CHECK(done.impulse[c] == Approx(mass * (v[c] - before[c])));
    lost += 0.5 * mass * (along[c] * along[c] - v[c] * v[c]);
  }
  CHECK(done.friction_work == Approx(lost));
}

TEST_CASE("the adjoint of an obstacle is its derivative") {
  const V bar{0.3, -1.1, 0.7};
  for (const Kind kind : {Kind::slip, Kind::no_slip, Kind::separate, Kind::friction})
    for (const double vn : {-1.0, 1.0}) {
      const auto value = [&](const V& v, double mu) {
        const V end = after(kind, v, mu);
        return bar[0] * end[0] + bar[1] * end[1] + bar[2] * end[2];
      };
      const V v = with_approach(vn);
      V by = bar;
      const double by_friction = obstacle_adjoint<double, 3>(kind, friction, normal, v, by);
      constexpr double h = 1e-6;
      INFO("kind " << int(kind) << ", approach " << vn);
      CHECK(by_friction == Approx((value(v, friction + h) - value(v, friction - h)) / (2 * h)).margin(1e-8));
      for (int c = 0; c < 3; ++c) {
        V more = v, less = v;
        more[c] += h, less[c] -= h;
        CHECK(by[c] == Approx((value(more, friction) - value(less, friction)) / (2 * h)).margin(1e-8));
      }
    }
}
