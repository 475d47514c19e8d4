// Drucker–Prager along the paths that have closed forms on its own cone τ = k_φ − q_φ σ_m.
#include "sand.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm::test {
namespace {

TEST_CASE("Drucker-Prager: constants of appendix A for 30 degrees") {
  const Sand law = Sand::from(sand(30, 0, 1000, 0));
  CHECK(law.friction == Approx(3 / (std::sqrt(3.0) * 3.5)).epsilon(1e-14));
  CHECK(law.cohesion == Approx(6000 * std::sqrt(0.75) / (std::sqrt(3.0) * 3.5)).epsilon(1e-14));
  CHECK(law.dilation == 0);
  const double K = 0.7e6, G = 3 * K * 0.4 / 2.6;
  CHECK(law.elasticity.shear == Approx(G).epsilon(1e-14));
  MaterialPoint<Sand, 3> point(law);
  CHECK(point.wave_speed() == Approx(std::sqrt((K + 4 * G / 3) / 2650)).epsilon(1e-14));
}

TEST_CASE("Drucker-Prager: confined compression yields and flows as the cone says") {
  for (const double psi : {0.0, 10.0}) {
    const Sand law = Sand::from(sand(20, psi, 2000, 0, 0.1));
    const double K = law.elasticity.bulk, G = law.elasticity.shear, q = law.friction, k = law.cohesion, root3 = std::sqrt(3.0);
    const double yield = k / (2 * G / root3 - q * K);  // 2Gε/√3 = k + qKε
    REQUIRE(yield > 0);
    const int steps = 300;
    MaterialPoint<Sand, 2> point(law);
    for (int step = 1; step <= steps; ++step) {
      const double d = 3 * yield / steps;
      point.advance(diagonal(0, -d));
      const double strain = d * step;
      const double lambda = std::max(0.0, (2 * G / root3 - q * K) * (strain - yield) / (G + K * q * law.dilation));
      const double m = -K * strain - K * law.dilation * lambda, tau = 2 * G * strain / root3 - G * lambda;
      CHECK(mean(point.stress()) == Approx(m).epsilon(1e-10));
      CHECK(shear_invariant(point.stress()) == Approx(tau).epsilon(1e-10));
      CHECK(point.stress()[1] == Approx(m - 2 * tau / root3).epsilon(1e-10));
      CHECK(point.stress()[0] == Approx(m + tau / root3).epsilon(1e-10));
      CHECK(point.plastic_strain() ==
            Approx(lambda * std::sqrt(1.0 / 3 + 2.0 / 9 * law.dilation * law.dilation)).epsilon(1e-9).margin(1e-14));
    }
  }
}

TEST_CASE("Drucker-Prager: triaxial compression at constant lateral stress fails at the cone's strength") {
  const double p0 = 5000;
  const Sand law = Sand::from(sand(28, 5, 800, 0));
  const ElasticModuli<> moduli{law.elasticity.bulk, law.elasticity.shear};
  const double E = 9 * moduli.bulk * moduli.shear / (3 * moduli.bulk + moduli.shear);
  MaterialPoint<Sand, 3> point(law);
  point.start({{-p0, -p0, -p0, 0, 0, 0}});
  const double d = 5e-5;
  double lateral = moduli.poisson_ratio() * d, peak = 0;
  for (int step = 1; step <= 2000; ++step) {
    // The lateral strain that keeps the lateral stress: Newton's method, its derivative by dual numbers.
    for (int iteration = 0; iteration < 30; ++iteration) {
      using D = Dual<double, 1>;
      MaterialPoint<Sand, 3> trial = point;
      std::vector<D> history(trial.history.begin(), trial.history.end());
      D compression(trial.compression);
      Matrix<D, 3> H{};
      H(0, 0) = H(1, 1) = D::variable(lateral, 0);
      H(2, 2) = D(-d);
      law.update<D, 3>(H, D(1), compression, history.data());
      lateral -= (history[0].value + p0) / history[0].derivative[0];
    }
    point.advance(diagonal(lateral, lateral, -d));
    if (step == 10) CHECK(-p0 - point.stress()[2] == Approx(10 * E * d).epsilon(1e-10));
    peak = -p0 - point.stress()[2];
    CHECK(point.stress()[0] == Approx(-p0).epsilon(1e-9));
  }
  // q/√3 = k_φ + q_φ (p0 + q/3)
  CHECK(peak == Approx((law.cohesion + law.friction * p0) / (1 / std::sqrt(3.0) - law.friction / 3)).epsilon(1e-10));
  CHECK(point.plastic_strain() > 0.01);
  CHECK(point.dissipated > 0);
}

TEST_CASE("Drucker-Prager: isotropic tension goes up to the cut-off and stays there") {
  const double cutoff = 300;
  const Sand law = Sand::from(sand(30, 0, 1000, cutoff));
  MaterialPoint<Sand, 3> point(law);
  const double d = 1e-5, K = law.elasticity.bulk;
  for (int step = 1; step <= 200; ++step) {
    point.advance(diagonal(d, d, d));
    CHECK(mean(point.stress()) == Approx(std::min(3 * K * d * step, cutoff)).epsilon(1e-12));
    CHECK(shear_invariant(point.stress()) < 1e-10);
  }
  CHECK(point.plastic_strain() == Approx(std::sqrt(2.0) / 3 * (3 * d * 200 - cutoff / K)).epsilon(1e-11));
  CHECK(point.dissipated == Approx(cutoff * (3 * d * 200 - cutoff / K)).epsilon(1e-11));
}

TEST_CASE("Drucker-Prager: pure shear under pressure flows at k + q p, and dissipates what is left of the work") {
  const double p0 = 2000, d = 1e-4;
  const Sand law = Sand::from(sand(33, 0, 500, 0));
  const double G = law.elasticity.shear, strength = law.cohesion + law.friction * p0;
  MaterialPoint<Sand, 2> point(law);
  point.start({{-p0, -p0, -p0, 0}});
  const double stored = point.energy();
  const int steps = 400;
  for (int step = 1; step <= steps; ++step) {
    point.advance({{0, d / 2, d / 2, 0}});
    CHECK(point.stress()[3] == Approx(std::min(G * d * step, strength)).epsilon(1e-11));
    CHECK(mean(point.stress()) == Approx(-p0).epsilon(1e-12));
  }
  const double beyond = d * steps - strength / G;
  CHECK(point.plastic_strain() == Approx(beyond / std::sqrt(3.0)).epsilon(1e-10));
  CHECK(point.dissipated == Approx(strength * beyond).epsilon(1e-10));
  CHECK(point.energy() - stored == Approx(0.5 * strength * strength / G).epsilon(1e-10));
}

TEST_CASE("Drucker-Prager: one rigid turn leaves the invariants and the plastic strain") {
  const Sand law = Sand::from(sand(30, 10, 0, 0));
  MaterialPoint<Sand, 3> point(law);
  point.start({{-1000, -1500, -800, 200, -100, 150}});
  const Symmetric<double, 3> first = point.stress();
  REQUIRE(outside(law, first) < 0);
  const double t = std::tan(std::acos(-1.0) / 1000), x = 2 * t * 2 / 3, y = -2 * t / 3, z = 2 * t * 2 / 3;
  for (int step = 0; step < 1000; ++step) point.advance({{0, -z, y, z, 0, -x, -y, x, 0}});
  const double error = std::max(std::abs(mean(point.stress()) / mean(first) - 1),
                                std::abs(half_square(deviator(point.stress())) / half_square(deviator(first)) - 1));
  WARN("largest relative change of an invariant in one turn: " << error);
  CHECK(error < 1e-10);
  for (int k = 0; k < 6; ++k) CHECK(point.stress()[k] == Approx(first[k]).epsilon(1e-10));
  CHECK(point.plastic_strain() == 0);
}

}  // namespace
}  // namespace jaxmpm::test
