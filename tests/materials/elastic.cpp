// Linear elasticity in rate form, elastic constants, and the exact rotation.
#include "drive.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace jaxmpm::test {
namespace {

LinearElastic<double> rubber() {
  deck::LinearElastic m;
  m.density = 1200;
  m.youngs_modulus = 2e6;
  m.poisson_ratio = 0.3;
  return LinearElastic<double>::from(m);
}

TEST_CASE("elastic constants: any two of K, E and nu give the same K and G") {
  const double E = 3e6, nu = 0.21, K = E / (3 * (1 - 2 * nu)), G = E / (2 * (1 + nu));
  deck::DruckerPrager m;
  m.youngs_modulus = E, m.poisson_ratio = nu;
  const ElasticModuli a = elastic_moduli(m);
  m.youngs_modulus.reset(), m.bulk_modulus = K;
  const ElasticModuli b = elastic_moduli(m);
  m.poisson_ratio.reset(), m.youngs_modulus = E;
  const ElasticModuli c = elastic_moduli(m);
  for (const auto& x : {a, b, c}) {
    CHECK(x.bulk == Approx(K).epsilon(1e-14));
    CHECK(x.shear == Approx(G).epsilon(1e-13));
    CHECK(x.poisson_ratio() == Approx(nu).epsilon(1e-13));
    CHECK(x.lame() == Approx(E * nu / ((1 + nu) * (1 - 2 * nu))).epsilon(1e-13));
  }
  CHECK(elastic_moduli(deck::Material(deck::Newtonian{1000, 10, 0, {}})).bulk == 1e5);
  CHECK(elastic_moduli(deck::Material(deck::Newtonian{1000, 10, 0, {}})).poisson_ratio() == 0.5);
}

TEST_CASE("linear elastic: uniaxial stress recovers E and nu, confined compression M, shear G, pressure K") {
  const double E = 2e6, nu = 0.3, K = E / (3 * (1 - 2 * nu)), G = E / (2 * (1 + nu)), strain = 1e-4;
  MaterialPoint<LinearElastic<double>, 3> rod(rubber());
  rod.advance(diagonal(strain, -nu * strain, -nu * strain));
  CHECK(rod.stress()[0] == Approx(E * strain).epsilon(1e-13));
  CHECK(std::abs(rod.stress()[1]) < 1e-13 * E * strain);
  CHECK(rod.energy() == Approx(0.5 * E * strain * strain).epsilon(1e-13));

  MaterialPoint<LinearElastic<double>, 2> confined(rubber());
  confined.advance(diagonal(0, -strain));
  CHECK(confined.stress()[1] == Approx(-(K + 4 * G / 3) * strain).epsilon(1e-13));
  CHECK(confined.stress()[0] == Approx(-(K - 2 * G / 3) * strain).epsilon(1e-13));
  CHECK(confined.stress()[2] == Approx(confined.stress()[0]).epsilon(1e-14));  // zz is kept in plane strain
  CHECK(confined.energy() == Approx(0.5 * (K + 4 * G / 3) * strain * strain).epsilon(1e-13));
  CHECK(confined.wave_speed() == Approx(std::sqrt((K + 4 * G / 3) / (1200 / (1 - strain)))).epsilon(1e-13));

  MaterialPoint<LinearElastic<double>, 3> shear(rubber());
  shear.advance({{0, 0, strain, 0, 0, 0, strain, 0, 0}});
  CHECK(shear.stress()[5] == Approx(2 * G * strain).epsilon(1e-14));

  MaterialPoint<LinearElastic<double>, 3> pressed(rubber());
  pressed.advance(diagonal(-strain, -strain, -strain));
  CHECK(mean(pressed.stress()) == Approx(-3 * K * strain).epsilon(1e-14));
  CHECK(shear_invariant(pressed.stress()) < 1e-12 * K * strain);
}

TEST_CASE("rotation: one turn in 1000 increments returns the stress, in plane strain and about any axis in space") {
  const double t = std::tan(std::acos(-1.0) / 1000);  // S of the Cayley transform that turns by 2π/1000
  MaterialPoint<LinearElastic<double>, 2> plane(rubber());
  const Symmetric<double, 2> first2{{-3e3, 1e3, -5e2, 2e3}};
  plane.start(first2);
  for (int step = 0; step < 1000; ++step) plane.advance({{0, -2 * t, 2 * t, 0}});
  for (int k = 0; k < 4; ++k) CHECK(plane.stress()[k] == Approx(first2[k]).margin(1e-8).epsilon(1e-11));

  MaterialPoint<LinearElastic<double>, 3> space(rubber());
  const Symmetric<double, 3> first3{{-3e3, 1e3, -5e2, 2e3, -7e2, 4e2}};
  space.start(first3);
  const double x = 2 * t * 2 / 3, y = -2 * t * 1 / 3, z = 2 * t * 2 / 3;  // unit axis (2, −1, 2)/3
  for (int step = 0; step < 1000; ++step) space.advance({{0, -z, y, z, 0, -x, -y, x, 0}});
  for (int k = 0; k < 6; ++k) CHECK(space.stress()[k] == Approx(first3[k]).margin(1e-8).epsilon(1e-11));
}

TEST_CASE("rotation: a quarter turn exchanges the axes, also in single precision") {
  const int steps = 20000;
  const double t = std::tan(std::acos(-1.0) / (4.0 * steps));
  deck::LinearElastic deck;
  deck.density = 1200, deck.youngs_modulus = 2e6, deck.poisson_ratio = 0.3;
  MaterialPoint<LinearElastic<float>, 2, float> point(LinearElastic<float>::from(deck));
  point.start({{1000, 0, 0, 0}});
  for (int step = 0; step < steps; ++step) point.advance({{0, float(-2 * t), float(2 * t), 0}});
  CHECK(std::abs(point.stress()[0]) < 1);
  CHECK(point.stress()[1] == Approx(1000).epsilon(1e-3));
  CHECK(std::abs(point.stress()[3]) < 1);
}

TEST_CASE("rotation: random finite spins are orthogonal") {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double worst = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Symmetric<double, 3> s;
    for (double& x : s.a) x = normal(random);
    const double a = normal(random), b = normal(random), c = normal(random);
    const Symmetric<double, 3> r = rotate(s, Matrix<double, 3>{{0, a, b, -a, 0, c, -b, -c, 0}});
    worst = std::max({worst, std::abs(trace(r) - trace(s)), std::abs(half_square(r) - half_square(s))});
  }
  CHECK(worst < 1e-13);
}

}  // namespace
}  // namespace jaxmpm::test
