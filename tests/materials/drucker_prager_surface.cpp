// Drucker–Prager's return: every zone and every border, admissibility, continuity, derivative.
#include "sand.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <random>

namespace jaxmpm::test {
namespace {

/// The last two have α^P K q_ψ > G, where the border of the tension zone follows the return direction.
std::vector<Sand> sands() {
  const Sand steep = Sand::from(sand(40, 40, 1000, 200, 0.45)), apex = Sand::from(sand(35, 35, 0, 0, 0.45));
  for (const Sand& law : {steep, apex}) {
    const double alpha = std::sqrt(1 + law.friction * law.friction) - law.friction;
    REQUIRE(alpha * law.elasticity.bulk * law.dilation > law.elasticity.shear);
  }
  const double q30 = Sand::from(sand(30, 0, 1000, 0)).friction, k30 = Sand::from(sand(30, 0, 1000, 0)).cohesion;
  return {Sand::from(sand(30, 0, 1000, 300)),
          Sand::from(sand(30, 12, 1000, k30 / q30)),  // cut-off below the apex and at it
          Sand::from(sand(19.8, 0, 0, 0)),
          Sand::from(sand(0, 0, 500, 100)),  // sand; purely cohesive
          Sand::from(sand(30, 20, 1000, 300)),
          steep,
          apex};
}

/// The stress scale of a law, Pa.
double scale(const Sand& law) { return std::max({law.cohesion, law.tension_cutoff, 500.0}); }

/// The stress state with these invariants along a deviatoric direction with s : s = 2.
Symmetric<double, 3> stress_with(double m, double shear, const Symmetric<double, 3>& direction) {
  Symmetric<double, 3> s;
  for (int k = 0; k < 6; ++k) s[k] = shear * direction[k];
  for (int k = 0; k < 3; ++k) s[k] += m;
  return s;
}

Symmetric<double, 3> random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Symmetric<double, 3> s;
  for (double& x : s.a) x = normal(random);
  s = deviator(s);
  const double size = std::sqrt(half_square(s));
  for (double& x : s.a) x /= size;
  return s;
}

/// The stress that the law makes of a trial stress, by the strain increment that leads there from zero stress.
Symmetric<double, 3> returned(const Sand& law, const Symmetric<double, 3>& trial) {
  const Symmetric<double, 3> s = deviator(trial);
  const double m = mean(trial) / (3 * law.elasticity.bulk), f = 0.5 / law.elasticity.shear;
  MaterialPoint<Sand, 3> point(law);
  point.advance({{m + f * s[0], f * s[3], f * s[5], f * s[3], m + f * s[1], f * s[4], f * s[5], f * s[4], m + f * s[2]}});
  return point.stress();
}

TEST_CASE("Drucker-Prager: every zone of appendix A returns where its branches say") {
  std::mt19937_64 random(11);
  std::map<Zone, int> visits;
  for (const Sand& law : sands()) {
    const double size = scale(law);
    std::uniform_real_distribution<double> mean_of(-4 * size, 4 * size), shear_of(0, 6 * size);
    for (int trial = 0; trial < 20000; ++trial) {
      const double m = mean_of(random), shear = shear_of(random);
      const Expected expected = by_branches(law, m, shear);
      const auto got = law.return_to_surface(m, shear);
      ++visits[expected.zone];
      if (std::abs(got.mean - expected.mean) > 1e-11 * size || std::abs(got.shear - expected.shear) > 1e-11 * size ||
          std::abs(got.plastic_strain - expected.plastic_strain) > 1e-14) {
        INFO("trial " << m << ", " << shear << " in zone " << int(expected.zone));
        CHECK(got.mean == Approx(expected.mean).margin(1e-11 * size));
        CHECK(got.shear == Approx(expected.shear).margin(1e-11 * size));
        CHECK(got.plastic_strain == Approx(expected.plastic_strain).margin(1e-14));
      }
    }
  }
  for (const Zone zone : {Zone::elastic, Zone::shear, Zone::corner_from_shear, Zone::tension, Zone::corner_from_tension})
    CHECK(visits[zone] > 1000);
}

TEST_CASE("Drucker-Prager: states on the borders themselves") {
  for (const Sand& law : sands()) {
    const double corner = law.cohesion - law.friction * law.tension_cutoff, size = scale(law);
    // On the cone, below the cut-off: elastic.
    const auto on_cone = law.return_to_surface(law.tension_cutoff - size, corner + law.friction * size);
    CHECK(on_cone.plastic_strain == Approx(0).margin(1e-15));
    CHECK(on_cone.shear == Approx(corner + law.friction * size).epsilon(1e-13));
    // On the cut-off: nothing to correct.
    const auto on_cutoff = law.return_to_surface(law.tension_cutoff, 0.5 * corner);
    CHECK(on_cutoff.mean == law.tension_cutoff);
    CHECK(on_cutoff.shear == Approx(0.5 * corner).margin(1e-12));
    CHECK(on_cutoff.plastic_strain == 0);
    // Anywhere on the border between shear and tension: the corner.
    for (const double far : {0.0, 0.1, 1.0, 10.0}) {
      const auto at = law.return_to_surface(law.tension_cutoff + far * size, corner + law.border_slope() * far * size);
      CHECK(at.mean == Approx(law.tension_cutoff).margin(1e-11 * size));
      CHECK(at.shear == Approx(corner).margin(1e-11 * size));
    }
  }
}

TEST_CASE("Drucker-Prager: 100,000 random increments never end outside the surface") {
  std::mt19937_64 random(2024);
  std::uniform_real_distribution<double> exponent(-7, 0);
  std::normal_distribution<double> normal;
  double worst = -1;
  for (const Sand& law : sands()) {
    MaterialPoint<Sand, 3> space(law);
    MaterialPoint<Sand, 2> plane(law);
    for (int step = 0; step < 15000; ++step) {
      const double size = std::pow(10, exponent(random));
      Matrix<double, 3> H;
      for (double& x : H.a) x = size * normal(random);
      space.compression = plane.compression = 0;
      space.advance(H);
      plane.advance({{H(0, 0), H(0, 1), H(1, 0), H(1, 1)}});
      for (const double out : {outside(law, space.stress()) / (scale(law) + std::abs(mean(space.stress()))),
                               outside(law, plane.stress()) / (scale(law) + std::abs(mean(plane.stress())))})
        worst = std::max(worst, out);
    }
  }
  WARN("farthest outside, relative to the stress: " << worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("Drucker-Prager: trial states 1e-8 apart give stresses O(1e-8) apart, across every border and at the apex") {
  std::mt19937_64 random(99);
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  for (const Sand& law : sands()) {
    const double size = scale(law), corner = law.cohesion - law.friction * law.tension_cutoff, near = 1e-8 * size;
    for (int trial = 0; trial < 30000; ++trial) {
      const double far = trial % 2 ? 3 * size * uniform(random) : std::pow(10.0, -10 * uniform(random)) * size;
      double m = 0, shear = 0;
      switch (trial % 6) {
        case 0:
          m = law.tension_cutoff - far, shear = corner + law.friction * far;
          break;  // elastic–shear
        case 1:
          m = law.tension_cutoff, shear = uniform(random) * corner;
          break;  // elastic–tension
        case 2:
          m = law.tension_cutoff + far, shear = corner + law.border_slope() * far;
          break;  // shear–tension
        case 3:
          m = law.tension_cutoff, shear = corner + far;
          break;  // the two kinds of zone II
        case 4:
          m = law.tension_cutoff + (uniform(random) - 0.5) * near, shear = corner + uniform(random) * near;
          break;  // the corner
        default:
          m = law.tension_cutoff + 3 * size * (uniform(random) - 0.7), shear = far;  // anywhere
      }
      const Symmetric<double, 3> direction = random_direction(random), offset = random_direction(random);
      const Symmetric<double, 3> a = stress_with(m, shear, direction);
      Symmetric<double, 3> b = a;
      for (int k = 0; k < 6; ++k) b[k] += near * offset[k];
      for (int k = 0; k < 3; ++k) b[k] += near * (uniform(random) - 0.5);
      const Symmetric<double, 3> ra = returned(law, a), rb = returned(law, b);
      double apart = 0, trial_apart = 0;
      for (int k = 0; k < 6; ++k) {
        apart = std::max(apart, std::abs(ra[k] - rb[k]));
        trial_apart = std::max(trial_apart, std::abs(a[k] - b[k]));
      }
      worst = std::max(worst, apart / trial_apart);
    }
  }
  WARN("largest ratio of stress difference to trial difference: " << worst);
  CHECK(worst < 10);
}

TEST_CASE("Drucker-Prager: the derivative by dual numbers is that of differences, in every zone") {
  std::mt19937_64 random(41);
  std::map<Zone, int> visits;
  using D = Dual<double, 9>;
  double worst = 0;
  for (const Sand& law : sands()) {
    const double size = scale(law);
    for (int trial = 0; trial < 400; ++trial) {
      std::uniform_real_distribution<double> mean_of(-3 * size, 3 * size), shear_of(0.1 * size, 4 * size);
      const double m = mean_of(random), shear = shear_of(random);
      const Symmetric<double, 3> at = stress_with(m, shear, random_direction(random));
      // A spin and a strain increment from that state, so small that it stays in the zone of (m, shear).
      const double h = 1e-7 * size / law.elasticity.bulk;
      const Zone zone = by_branches(law, m, shear).zone;
      bool near_border = false;
      for (const double dm : {-30.0, 0.0, 30.0})
        for (const double ds : {-30.0, 0.0, 30.0})
          near_border = near_border || by_branches(law, m + dm * 1e-6 * size, shear + ds * 1e-6 * size).zone != zone;
      if (near_border) continue;
      ++visits[zone];
      D compression(0), history[7];
      for (int k = 0; k < 6; ++k) history[k] = D(at[k]);
      Matrix<D, 3> H;
      for (int k = 0; k < 9; ++k) H.a[k] = D::variable(0, k);
      const D work = law.update<D, 3>(H, D(1), compression, history);
      CHECK(std::isfinite(work.derivative[0]));
      for (int k = 0; k < 9; ++k) {
        double plus[7]{}, minus[7]{}, e = 0;
        for (int j = 0; j < 6; ++j) plus[j] = minus[j] = at[j];
        Matrix<double, 3> P{}, M{};
        P.a[k] = h, M.a[k] = -h;
        law.update<double, 3>(P, 1, e, plus);
        law.update<double, 3>(M, 1, e, minus);
        for (int j = 0; j < 7; ++j) {
          const double unit = j < 6 ? law.elasticity.bulk : 1;
          worst = std::max(worst, std::abs((plus[j] - minus[j]) / (2 * h) - history[j].derivative[k]) / unit);
        }
      }
    }
  }
  for (const auto& [zone, count] : visits) CHECK(count > 20);
  CHECK(visits.size() == 5);
  WARN("largest difference between dual and central differences, relative to K: " << worst);
  CHECK(worst < 1e-6);
}

TEST_CASE("Drucker-Prager: a stress-free grain has finite derivatives") {
  const Sand law = Sand::from(sand(30, 0, 0, 0));
  using D = Dual<double, 4>;
  Matrix<D, 2> H;
  for (int k = 0; k < 4; ++k) H.a[k] = D::variable(0, k);
  D compression(0), history[5];
  law.update<D, 2>(H, D(1), compression, history);
  for (const D& value : history)
    for (const double d : value.derivative) CHECK(std::isfinite(d));
}

}  // namespace
}  // namespace jaxmpm::test
