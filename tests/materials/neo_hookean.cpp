// The compressible neo-Hookean solid against its closed forms.
#include "drive.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace jaxmpm::test {
namespace {

constexpr double E = 1e6, nu = 0.3;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));

template <class Scalar>
NeoHookean<Scalar> soft() {
  deck::NeoHookean m;
  m.density = 1000;
  m.youngs_modulus = E;
  m.poisson_ratio = nu;
  return NeoHookean<Scalar>::from(m);
}

Matrix<double, 3> random_increment(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  Matrix<double, 3> H;
  for (double& x : H.a) x = uniform(random);
  return H;
}

TEST_CASE("neo-Hookean: uniaxial and equal stretch in many increments") {
  for (const double end : {0.5, 0.9, 1.3, 2.0}) {
    const int steps = 400;
    const double H = std::pow(end, 1.0 / steps) - 1;
    MaterialPoint<NeoHookean<double>, 2> one(soft<double>());
    MaterialPoint<NeoHookean<double>, 3> all(soft<double>());
    for (int step = 0; step < steps; ++step) one.advance(diagonal(0, H)), all.advance(diagonal(H, H, H));
    const double J = end * end * end;
    CHECK(one.stress()[1] == Approx((mu * (end * end - 1) + lambda * std::log(end)) / end).epsilon(1e-12));
    CHECK(one.stress()[0] == Approx(lambda * std::log(end) / end).epsilon(1e-12));
    CHECK(one.stress()[2] == Approx(lambda * std::log(end) / end).epsilon(1e-12));
    CHECK(1 + one.compression == Approx(1 / end).epsilon(1e-12));
    for (int k = 0; k < 3; ++k) CHECK(all.stress()[k] == Approx((mu * (end * end - 1) + lambda * std::log(J)) / J).epsilon(1e-11));
    CHECK(1 + all.compression == Approx(1 / J).epsilon(1e-11));
  }
}

TEST_CASE("neo-Hookean: small strains are Hooke's, also in single precision") {
  const double strain = 1e-6;
  MaterialPoint<NeoHookean<float>, 2, float> point(soft<float>());
  for (int step = 0; step < 100; ++step) point.advance({{0, float(strain / 100), float(strain / 100), float(-strain / 100)}});
  CHECK(point.stress()[1] == Approx(-(lambda + 2 * mu) * strain).epsilon(2e-5));
  CHECK(point.stress()[0] == Approx(-lambda * strain).epsilon(2e-5));
  CHECK(point.stress()[3] == Approx(2 * mu * strain).epsilon(2e-5));
  CHECK(point.energy() == Approx((0.5 * (lambda + 2 * mu) + 2 * mu) * strain * strain).epsilon(1e-4));
  CHECK(point.wave_speed() == Approx(std::sqrt((lambda + 2 * mu) / 1000)).epsilon(1e-5));
}

TEST_CASE("neo-Hookean: turning the body turns the stress") {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    MaterialPoint<NeoHookean<double>, 3> point(soft<double>());
    point.advance(random_increment(random, 0.2));
    const Symmetric<double, 3> before = point.stress();
    // The Cayley transform of a random skew matrix, applied to the stress by rotate() and to F as I + H.
    const Matrix<double, 3> W = random_increment(random, 2);
    const Matrix<double, 3> skew{{0, W(0, 1), W(0, 2), -W(0, 1), 0, W(1, 2), -W(0, 2), -W(1, 2), 0}};
    Matrix<double, 3> H{};  // columns: what the rotation adds to each unit vector, 2 (S + S²)/(1 + a²) with S = W/2
    const double a2 = (W(0, 1) * W(0, 1) + W(0, 2) * W(0, 2) + W(1, 2) * W(1, 2)) / 4;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        double square = 0;
        for (int k = 0; k < 3; ++k) square += skew(i, k) * skew(k, j) / 4;
        H(i, j) = 2 * (skew(i, j) / 2 + square) / (1 + a2);
      }
    point.advance(H);
    const Symmetric<double, 3> turned = rotate(before, skew), after = point.stress();
    for (int k = 0; k < 6; ++k) CHECK(after[k] == Approx(turned[k]).margin(1e-12 * E));
    MaterialPoint<NeoHookean<double>, 3> rigid(soft<double>());
    rigid.advance(H);
    for (int k = 0; k < 6; ++k) CHECK(std::abs(rigid.stress()[k]) < 1e-14 * E);
  }
}

TEST_CASE("neo-Hookean: the energy is the work done, in plane strain and in space") {
  std::mt19937_64 random(5);
  for (const double size : {1e-6, 1e-3, 0.1, 0.3}) {
    MaterialPoint<NeoHookean<double>, 3> space(soft<double>());
    const Matrix<double, 3> H = random_increment(random, size);
    space.advance(H);
    CHECK(work_error(space, E * size) < 1e-12);
    MaterialPoint<NeoHookean<double>, 2> plane(soft<double>());
    plane.advance({{H(0, 0), H(0, 1), H(1, 0), H(1, 1)}});
    CHECK(work_error(plane, E * size) < 1e-12);
    CHECK(plane.energy() > 0);
  }
}

TEST_CASE("neo-Hookean: the wave speed bounds every plane pressure wave") {
  for (const double stretch : {0.6, 0.95, 1.0, 1.4, 2.0}) {
    MaterialPoint<NeoHookean<double>, 3> point(soft<double>());
    point.advance(diagonal(stretch - 1, 0, 0));
    const double exact = std::sqrt((mu * (stretch * stretch + 1) + lambda * (1 - std::log(stretch))) / 1000);
    CHECK(point.wave_speed() >= exact * (1 - 1e-14));
    if (stretch >= 1) CHECK(point.wave_speed() == Approx(exact).epsilon(1e-13));
  }
}

TEST_CASE("neo-Hookean: starts with the stress it is given") {
  MaterialPoint<NeoHookean<double>, 3> space(soft<double>());
  const Symmetric<double, 3> s3{{-0.1 * mu, -0.25 * mu, 0.1 * mu, 0.05 * mu, -0.04 * mu, 0.1 * mu}};
  space.start(s3);
  for (int k = 0; k < 6; ++k) CHECK(space.stress()[k] == Approx(s3[k]).margin(1e-13 * mu));
  MaterialPoint<NeoHookean<double>, 2> plane(soft<double>());
  const Symmetric<double, 2> s2{{-0.1 * mu, -0.25 * mu, 0, 0.05 * mu}};
  plane.start(s2);
  for (const int k : {0, 1, 3}) CHECK(plane.stress()[k] == Approx(s2[k]).margin(1e-13 * mu));
}

}  // namespace
}  // namespace jaxmpm::test
