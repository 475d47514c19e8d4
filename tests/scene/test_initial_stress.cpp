// Initial stress, density and mass.
#include <catch2/catch.hpp>
#include <cmath>

#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;
using Kind = deck::InitialStress::Kind;

TEST_CASE("Hydrostatic water follows the exponential profile, along any axis") {
  for (const int axis : {0, 1, 2})
    for (const double sign : {-1.0, 1.0}) {
      deck::Deck deck = water_deck({0, 0, 0}, {0.2, 0.2, 0.2}, 0.05, box({0, 0, 0}, {0.2, 0.2, 0.2}));
      deck.gravity = {0, 0, 0};
      deck.gravity[axis] = sign * 9.81;
      deck.bodies[0].initial_stress.kind = Kind::hydrostatic;
      const BodyState state = build_model(deck).bodies[0].initial;
      REQUIRE(state.stress.size() == 512);
      for (std::size_t p = 0; p < state.id.size(); ++p) {
        const double along = state.position[p][axis] * 0.05, depth = sign > 0 ? along : 0.2 - along;
        const double e = std::expm1(9.81 * depth / (35 * 35));
        REQUIRE(state.compression[p] == Approx(e).epsilon(1e-10));
        REQUIRE(state.mass[p] == Approx(1000 * (1 + e) * std::pow(0.025, 3)).epsilon(1e-10));
        for (int k = 0; k < 6; ++k) REQUIRE(state.stress[p][k] == Approx(k < 3 ? -1000 * 35 * 35 * e : 0.0).epsilon(1e-10).margin(1e-9));
      }
    }
}

TEST_CASE("Geostatic and k0 sand") {
  deck::Deck deck = water_deck({0, 0}, {0.2, 0.2}, 0.01, box({0, 0}, {0.2, 0.1}));
  deck.bodies[0].material = "sand";
  deck.bodies[0].initial_stress.kind = Kind::geostatic;
  const BodyState geostatic = build_model(deck).bodies[0].initial;
  deck.bodies[0].initial_stress.kind = Kind::k0;
  deck.bodies[0].initial_stress.k0 = 0.6;
  const BodyState k0 = build_model(deck).bodies[0].initial;
  for (std::size_t p = 0; p < k0.id.size(); ++p) {
    const double depth = 0.1 - k0.position[p][1] * 0.01, weight = 2650 * 9.81 * depth;
    REQUIRE(geostatic.stress[p][1] == Approx(-weight).epsilon(0.003));
    REQUIRE(geostatic.stress[p][0] == Approx(geostatic.stress[p][1] * 0.3 / 0.7));
    REQUIRE(geostatic.stress[p][2] == Approx(geostatic.stress[p][0]));
    REQUIRE(k0.stress[p][0] == Approx(0.6 * k0.stress[p][1]));
    const double pressure = -(k0.stress[p][0] + k0.stress[p][1] + k0.stress[p][2]) / 3;
    REQUIRE(k0.compression[p] == Approx(pressure / 0.7e6));
  }
  // Equilibrium: the stress at the foot bears the mass above.
  double mass = 0, foot = 0;
  for (std::size_t p = 0; p < 20; ++p) {
    mass += k0.mass[p];
    if (p == 0) foot = -k0.stress[p][1];
  }
  CHECK((mass - 0.5 * k0.mass[0]) * 9.81 / 0.005 == Approx(foot).epsilon(1e-5));
}

TEST_CASE("Weights of bodies that lie on each other add up, whatever their lattices") {
  deck::Deck deck = water_deck({0, 0}, {0.4, 0.4}, 0.1, box({0, 0.2}, {0.4, 0.3}));
  deck.bodies[0].spacing = 0.02;
  deck.bodies.push_back(deck.bodies[0]);
  deck.bodies[1].name = "bed";
  deck.bodies[1].material = "sand";
  deck.bodies[1].spacing.reset();
  deck.bodies[1].shape = box({0, 0}, {0.2, 0.2});
  deck.bodies[1].initial_stress.kind = Kind::geostatic;
  const Model model = build_model(deck);
  CHECK(model.bodies[0].initial.stress.empty());
  CHECK(model.bodies[0].initial.compression[0] == 0);
  const BodyState& bed = model.bodies[1].initial;
  CHECK(-bed.stress[3][1] == Approx(9.81 * (1000 * 0.1 + 2650 * 0.025)).epsilon(1e-3));
  CHECK(-bed.stress[0][1] == Approx(9.81 * (1000 * 0.1 + 2650 * 0.175)).epsilon(5e-3));
}

TEST_CASE("An obstacle in a pool does not part its water") {
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {4, 3}));
  deck.bodies[0].initial_stress.kind = Kind::hydrostatic;
  deck.obstacles.push_back({"beam", box({1, 1}, {2, 2}), deck::ContactKind::separate, 0});
  const BodyState state = build_model(deck).bodies[0].initial;
  double beside = 0, below = 0;
  for (std::size_t p = 0; p < state.id.size(); ++p) {
    if (state.position[p] == Point{0.25, 0.25, 0}) beside = state.compression[p];
    if (state.position[p] == Point{1.25, 0.25, 0}) below = state.compression[p];
  }
  CHECK(below > 0);
  CHECK(below == Approx(beside).epsilon(1e-12));
}

TEST_CASE("Tilted gravity needs a point of the surface and turns the stress") {
  deck::Deck deck = water_deck({0, 0}, {0.4, 0.4}, 0.1, box({0, 0}, {0.4, 0.2}));
  deck.bodies[0].material = "sand";
  deck.bodies[0].initial_stress.kind = Kind::k0;
  deck.bodies[0].initial_stress.k0 = 0.5;
  const double tilt = 0.3;
  deck.gravity = {9.81 * std::sin(tilt), -9.81 * std::cos(tilt)};
  CHECK(problem_pointer(deck) == "/bodies/0/initial_stress");
  deck.bodies[0].initial_stress.surface = deck::SurfacePoint{{0.0, 0.3}};
  const BodyState state = build_model(deck).bodies[0].initial;
  const double depth = 0.025 * std::sin(tilt) + (0.3 - 0.025) * std::cos(tilt);
  const auto& s = state.stress[0];
  const Point g{std::sin(tilt), -std::cos(tilt), 0};
  CHECK(g[0] * g[0] * s[0] + g[1] * g[1] * s[1] + 2 * g[0] * g[1] * s[3] == Approx(-2650 * 9.81 * depth).epsilon(0.01));
  CHECK(s[0] + s[1] == Approx(3 * s[2]));  // vertical + lateral = (1/k + 1) lateral with k = 1/2
}

TEST_CASE("Initial stress that cannot be is refused") {
  deck::Deck deck = water_deck({0, 0}, {0.4, 0.4}, 0.1, box({0, 0}, {0.4, 0.2}));
  deck.bodies[0].initial_stress.kind = Kind::geostatic;
  CHECK(problem_pointer(deck) == "/bodies/0/initial_stress");
  deck.bodies[0].initial_stress.kind = Kind::hydrostatic;
  deck.gravity = {0, 0};
  CHECK(problem_pointer(deck) == "/bodies/0/initial_stress");
}
