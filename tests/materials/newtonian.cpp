// The weakly compressible fluid against its closed forms.
#include "drive.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm::test {
namespace {

deck::Newtonian water(double viscosity, std::optional<double> tension_limit = {}) {
  deck::Newtonian m;
  m.density = 1000;
  m.sound_speed = 35;
  m.viscosity = viscosity;
  m.tension_limit = tension_limit;
  return m;
}

TEST_CASE("fluid: density follows rho/(1 + tr d) and pressure c^2 (rho - rho0)") {
  MaterialPoint<InviscidFluid<double>, 3> point(InviscidFluid<double>::from(water(0)));
  double density = 1000;
  for (int step = 0; step < 50; ++step) {
    const double theta = step % 3 == 0 ? 1e-3 : -2e-3;
    point.advance(diagonal(theta, 2 * theta, -theta));
    density /= 1 + 2 * theta;
  }
  CHECK(1000 * (1 + point.compression) == Approx(density).epsilon(1e-13));
  const Symmetric<double, 3> s = point.stress();
  for (int k = 0; k < 3; ++k) CHECK(s[k] == Approx(-35.0 * 35.0 * (density - 1000)).epsilon(1e-12));
  for (int k = 3; k < 6; ++k) CHECK(s[k] == 0);
  CHECK(point.wave_speed() == 35);
  CHECK(point.law.diffusivity() == 0);
}

TEST_CASE("fluid: single precision keeps a compression of 1e-9") {
  MaterialPoint<InviscidFluid<float>, 2, float> point(InviscidFluid<float>::from(water(0)));
  for (int step = 0; step < 1000; ++step) point.advance({{-1e-12f, 0, 0, 0}});
  CHECK(point.compression == Approx(1e-9).epsilon(1e-4));
}

TEST_CASE("fluid: pressure and density are cut at the tension limit, and close again at once") {
  for (const double limit : {0.0, 500.0}) {
    MaterialPoint<InviscidFluid<double>, 2> point(InviscidFluid<double>::from(water(0, limit)));
    point.advance(diagonal(0.1, 0.1));
    CHECK(mean(point.stress()) == Approx(limit).margin(1e-9));
    CHECK(point.compression == Approx(-limit / (1000 * 35.0 * 35.0)).margin(1e-15));
    point.advance(diagonal(-0.001, 0));
    CHECK(mean(point.stress()) < limit - 1000);
  }
  MaterialPoint<InviscidFluid<double>, 2> without(InviscidFluid<double>::from(water(0)));
  without.advance(diagonal(0.1, 0.1));
  CHECK(1 + without.compression == Approx(1 / 1.2).epsilon(1e-14));
}

TEST_CASE("fluid: viscous stress is 2 mu dev d of the rate, with the third of the trace also in plane strain") {
  const double mu = 2.5, dt = 1e-3, rate = 40;
  MaterialPoint<ViscousFluid<double>, 2> shear(ViscousFluid<double>::from(water(mu)));
  shear.advance({{0, rate * dt, 0, 0}}, dt);
  CHECK(shear.stress()[3] == Approx(mu * rate).epsilon(1e-14));
  CHECK(shear.compression == 0);
  CHECK(shear.dissipated == Approx(mu * rate * rate * dt).epsilon(1e-14));

  MaterialPoint<ViscousFluid<double>, 2> plane(ViscousFluid<double>::from(water(mu)));
  plane.advance(diagonal(rate * dt, 0), dt);
  const double pressure = 1000 * 35.0 * 35.0 * plane.compression;
  CHECK(plane.stress()[0] == Approx(-pressure + 4.0 / 3.0 * mu * rate).epsilon(1e-13));
  CHECK(plane.stress()[2] == Approx(-pressure - 2.0 / 3.0 * mu * rate).epsilon(1e-13));
  CHECK(plane.dissipated == Approx(4.0 / 3.0 * mu * rate * rate * dt).epsilon(1e-13));
  CHECK(plane.law.diffusivity() == Approx(4.0 / 3.0 * mu / 1000).epsilon(1e-14));

  MaterialPoint<ViscousFluid<double>, 3> turn(ViscousFluid<double>::from(water(mu)));
  turn.advance({{0, -0.1, 0.2, 0.1, 0, -0.3, -0.2, 0.3, 0}}, dt);
  for (int k = 0; k < 6; ++k) CHECK(turn.stress()[k] == 0);
}

TEST_CASE("fluid: the energy is the work done, for small and large compression") {
  for (const double e : {1e-7, 1e-3, 0.029, 0.031, 0.3, -0.2}) {
    MaterialPoint<InviscidFluid<double>, 3> point(InviscidFluid<double>::from(water(0)));
    point.compression = e;
    const double bulk = 1000 * 35.0 * 35.0;
    CHECK(work_error(point, bulk * std::abs(e)) < 1e-13);
    CHECK(point.energy() == Approx(bulk * e * e * (0.5 - e / 6 + e * e / 12)).epsilon(std::abs(e * e * e) + 1e-13));
  }
}

TEST_CASE("fluid: a given stress at the start is the stress of the first step") {
  MaterialPoint<ViscousFluid<double>, 2> point(ViscousFluid<double>::from(water(1)));
  point.compression = 1e-3;
  const double p = 1000 * 35.0 * 35.0 * 1e-3;
  point.start({{-p, -p, -p, 0}});
  for (int k = 0; k < 3; ++k) CHECK(point.stress()[k] == Approx(-p).epsilon(1e-13));
}

}  // namespace
}  // namespace jaxmpm::test
