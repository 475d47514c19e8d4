// Derivatives by numbers of the deck against central differences of build_model.
#include "inverse/scene_gradient.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "../deck/example.hpp"
#include "fields/mlp.hpp"
#include "fields/random.hpp"
#include "materials/constants.hpp"

using namespace jaxmpm;

namespace {

/// Two bodies on each other along gravity, a third beside them, all that may be an unknown.
const char* const stacked = R"deck({
  "jaxmpm": 1,
  "domain": { "min": [0, 0], "max": [1, 0.8], "cell_size": 0.1 },
  "gravity": [0, -9.81], "time": { "end": 0.1 },
  "method": { "transfer": "flip", "flip_fraction": 0.9 },
  "parameters": { "u": 0.5, "k": 2 },
  "materials": {
    "water": { "model": "newtonian", "density": 1000, "sound_speed": 20, "viscosity": 0.1, "tension_limit": 5 },
    "sand": { "model": "drucker_prager", "density": 1600, "friction_angle": 30, "youngs_modulus": 1e6, "poisson_ratio": 0.3, "cohesion": 100 },
    "clay": { "model": "drucker_prager", "density": 1800, "friction_angle": 20, "bulk_modulus": 2e5, "poisson_ratio": 0.35 },
    "rubber": { "model": "neo_hookean", "density": 1100, "youngs_modulus": 1e5, "poisson_ratio": 0.4 } },
  "bodies": [
    { "name": "pool", "material": "water", "shape": { "box": { "min": [0, 0.4], "max": [0.6, 0.6] } }, "initial_stress": "hydrostatic",
      "velocity": ["u*sin(k*y)", 0.25] },
    { "name": "bed", "material": "sand", "spacing": 0.04, "shape": { "box": { "min": [0, 0.12], "max": [0.5, 0.4] } },
      "initial_stress": { "k0": 0.6 },
      "velocity": ["y < 0.3 ? u*x^k : 0", { "mlp": { "inputs": ["x", "y"], "hidden": [6, 5], "activation": "tanh", "seed": 3,
                                                     "input_scale": [2, 1], "output_scale": 0.5 } }] },
    { "name": "base", "material": "clay", "shape": { "box": { "min": [0, 0], "max": [0.7, 0.1] } }, "initial_stress": "geostatic" },
    { "name": "ball", "material": "rubber", "shape": { "sphere": { "center": [0.8, 0.5], "radius": 0.1 } } },
    { "name": "pebble", "material": "sand", "shape": { "box": { "min": [0.8, 0], "max": [0.9, 0.1] } } } ],
  "walls": { "x_min": { "kind": "friction", "coefficient": 0.3, "velocity": [0, 0.2] },
             "y_min": { "kind": "friction", "segments": [ { "to": 0.4, "coefficient": 0.5 }, { "to": 1.0, "coefficient": 0.1 } ] } },
  "obstacles": [ { "name": "beam", "shape": { "box": { "min": [0.2, 0.45], "max": [0.3, 0.5] } }, "kind": "friction", "coefficient": 0.2 } ],
  "output": { "interval": 0.05 } })deck";

/// Gravity along no axis, with a free surface given.
const char* const tilted = R"({
  "jaxmpm": 1,
  "domain": { "min": [0, 0, 0], "max": [0.4, 0.3, 0.3], "cell_size": 0.1 },
  "gravity": [3, -1, -9], "time": { "end": 0.1 },
  "materials": { "earth": { "model": "linear_elastic", "density": 1700, "youngs_modulus": 2e5, "poisson_ratio": 0.25 } },
  "bodies": [
    { "name": "slab", "material": "earth", "shape": { "box": { "min": [0, 0, 0], "max": [0.4, 0.3, 0.2] } },
      "initial_stress": { "kind": "geostatic", "surface": { "point": [0, 0, 0.3] } } },
    { "name": "lid", "material": "earth", "shape": { "box": { "min": [0, 0, 0.2], "max": [0.4, 0.3, 0.3] } },
      "initial_stress": { "k0": 0.5, "surface": { "point": [0.1, 0, 0.25] } }, "velocity": [0.1, 0, -0.2] } ],
  "output": { "interval": 0.05 } })";

/// A loss that is linear in everything of the model, with random slopes.
ModelGradient random_gradient(const Model& model) {
  RandomStream random(8);
  ModelGradient g;
  for (int a = 0; a < model.dim; ++a) g.gravity[a] = random.normal();
  g.flip_fraction = random.normal();
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t k = 0; k < model.faces[face].coefficient.size(); ++k) g.coefficient[face].push_back(random.normal());
  for (Point& face : g.wall_velocity) face = {random.normal(), random.normal(), 0};
  for (std::size_t o = 0; o < model.obstacles.size(); ++o) g.obstacle_coefficient.push_back(random.normal());
  for (const Body& body : model.bodies) {
    BodyGradient by;
    for (std::size_t p = 0; p < body.initial.id.size(); ++p) {
      by.initial.mass.push_back(random.normal());
      by.initial.compression.push_back(100 * random.normal());
      by.initial.velocity.push_back({random.normal(), random.normal(), model.dim == 3 ? random.normal() : 0});
      by.initial.stress.emplace_back();
      for (double& component : by.initial.stress.back()) component = 1e-3 * random.normal();
    }
    for (const auto& [key, number] : std::visit([](const auto& m) { return material_numbers(m); }, body.material))
      by.material[key] = random.normal() / (1 + std::abs(*number));
    g.bodies.push_back(std::move(by));
  }
  return g;
}

double loss_of_body(const Body& body, const BodyGradient& by) {
  double sum = 0;
  for (std::size_t p = 0; p < body.initial.id.size(); ++p) {
    sum += by.initial.mass[p] * body.initial.mass[p] + by.initial.compression[p] * body.initial.compression[p];
    for (int a = 0; a < 3; ++a) sum += by.initial.velocity[p][a] * body.initial.velocity[p][a];
    for (int k = 0; k < 6 && !body.initial.stress.empty(); ++k) sum += by.initial.stress[p][k] * body.initial.stress[p][k];
  }
  for (const auto& [key, number] : std::visit([](const auto& m) { return material_numbers(m); }, body.material))
    sum += by.material.at(key) * *number;
  return sum;
}

double linear_loss(const Model& model, const ModelGradient& g) {
  double sum = g.flip_fraction * model.method.flip_fraction;
  for (int a = 0; a < model.dim; ++a) sum += g.gravity[a] * model.gravity[a];
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t k = 0; k < g.coefficient[face].size(); ++k) sum += g.coefficient[face][k] * model.faces[face].coefficient[k];
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t c = 0; c < 2; ++c) sum += g.wall_velocity[face][c] * model.faces[face].velocity[c];
  for (std::size_t o = 0; o < g.obstacle_coefficient.size(); ++o) sum += g.obstacle_coefficient[o] * model.obstacles[o].coefficient;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) sum += loss_of_body(model.bodies[b], g.bodies[b]);
  return sum;
}

std::string assignment(const std::string& pointer, double value) { return pointer + "=" + nlohmann::json(value).dump(); }

void check(const char* text, const std::vector<std::string>& pointers) {
  const test::Folder folder;
  const deck::Deck deck = deck::read_deck(folder.file("deck.json", text));
  const Model model = build_model(deck);
  const ModelGradient gradient = random_gradient(model);
  const auto exact = gradient_by_pointer(deck, model, gradient, pointers);
  const nlohmann::json resolved = nlohmann::json::parse(deck.resolved);
  for (const std::string& pointer : pointers) {
    const double value = resolved.at(nlohmann::json::json_pointer(pointer)).get<double>(), step = 1e-4 * std::max(1e-2, std::abs(value));
    // Richardson's extrapolation of central differences: their error is of fourth order.
    const auto slope = [&](double h) {
      return (linear_loss(build_model(deck::with_assignments(deck, {assignment(pointer, value + h)})), gradient) -
              linear_loss(build_model(deck::with_assignments(deck, {assignment(pointer, value - h)})), gradient)) /
             (2 * h);
    };
    INFO(pointer);
    REQUIRE(exact.at(pointer).size() == 1);
    CHECK(exact.at(pointer)[0] == Approx((4 * slope(step / 2) - slope(step)) / 3).epsilon(1e-7));
  }
}

}  // namespace

TEST_CASE("every kind of number: step, masses, weight and expressions") {
  check(stacked, {"/gravity/1",
                  "/method/flip_fraction",
                  "/parameters/u",
                  "/parameters/k",
                  "/materials/water/density",
                  "/materials/water/sound_speed",
                  "/materials/water/viscosity",
                  "/materials/water/tension_limit",
                  "/materials/sand/density",
                  "/materials/sand/youngs_modulus",
                  "/materials/sand/poisson_ratio",
                  "/materials/sand/friction_angle",
                  "/materials/sand/cohesion",
                  "/materials/clay/density",
                  "/materials/clay/bulk_modulus",
                  "/materials/clay/poisson_ratio",
                  "/materials/rubber/density",
                  "/materials/rubber/youngs_modulus",
                  "/walls/x_min/coefficient",
                  "/walls/x_min/velocity/1",
                  "/walls/y_min/segments/0/coefficient",
                  "/walls/y_min/segments/1/coefficient",
                  "/obstacles/0/coefficient",
                  "/bodies/0/velocity/1",
                  "/bodies/1/initial_stress/k0"});
}

TEST_CASE("weight across a surface: gravity turns with all its components") {
  check(tilted, {"/gravity/0", "/gravity/1", "/gravity/2", "/materials/earth/density", "/materials/earth/youngs_modulus",
                 "/materials/earth/poisson_ratio", "/bodies/1/initial_stress/k0", "/bodies/1/velocity/0", "/bodies/1/velocity/2"});
}

TEST_CASE("weights of a network and velocities of particles, all at once") {
  const test::Folder folder;
  deck::Deck deck = deck::read_deck(folder.file("deck.json", stacked));
  const Model model = build_model(deck);
  const ModelGradient gradient = random_gradient(model);
  const std::string pointer = "/bodies/1/velocity/1/mlp";
  const std::vector<double> exact = gradient_by_pointer(deck, model, gradient, {pointer}).at(pointer);
  auto& network = std::get<deck::Mlp>(std::get<std::vector<deck::Component>>(deck.bodies[1].velocity)[1]);
  network.weights = Mlp(network, 2, pointer).weights();
  REQUIRE(exact.size() == network.weights.size());
  for (const std::size_t k : {std::size_t(0), std::size_t(7), std::size_t(15), std::size_t(40), exact.size() - 1}) {
    const double own = network.weights[k];
    double loss[2];
    for (const int side : {0, 1}) {
      network.weights[k] = own + (side == 0 ? 1e-5 : -1e-5);
      loss[side] = linear_loss(build_model(deck), gradient);
    }
    network.weights[k] = own;
    CHECK(exact[k] == Approx((loss[0] - loss[1]) / 2e-5).epsilon(1e-7).margin(1e-7));
  }

  deck.bodies[0].velocity = deck::ParticleFile{"v.csv"};
  const std::vector<double> by =
      gradient_by_pointer(deck, model, gradient, {"/bodies/0/velocity/particles"}).at("/bodies/0/velocity/particles");
  REQUIRE(by.size() == 2 * model.bodies[0].initial.id.size());
  CHECK(by[2 * 5 + 1] == gradient.bodies[0].initial.velocity[5][1]);
}

TEST_CASE("what has no derivative is refused by its pointer") {
  const test::Folder folder;
  const deck::Deck deck = deck::read_deck(folder.file("deck.json", stacked));
  const Model model = build_model(deck);
  const ModelGradient gradient = random_gradient(model);
  const auto refused = [&](const deck::Deck& of, const std::string& pointer, const std::string& at, const std::string& message) {
    try {
      gradient_by_pointer(of, model, gradient, {pointer});
      FAIL_CHECK(pointer << " was accepted");
    } catch (const DeckError& error) {
      CHECK(error.problems.at(0).pointer == at);
      CHECK_THAT(std::string(error.what()), Catch::Contains(message));
    }
  };
  for (const char* pointer : {"/domain/cell_size", "/materials/water/friction_angle", "/materials/air/density", "/bodies/9/velocity/0",
                              "/bodies/0/velocity/0", "/bodies/0/velocity/particles", "/walls/x_max/coefficient", "/gravity"})
    refused(deck, pointer, pointer, "no number of the step");
  refused(deck, "/gravity/0", "/gravity/0", "along its axis only");
  refused(deck, "/method/damping", "/method/damping", "start above 0");
  refused(deck, "/body_force/0", "/body_force/0", "no number of the step");
  refused(deck::with_assignments(deck, {"/materials/water/viscosity=0"}), "/materials/water/viscosity", "/materials/water/viscosity",
          "start above 0");
  refused(deck::with_assignments(deck, {"/bodies/0/velocity/0=\"abs(u)*k\""}), "/parameters/u", "/bodies/0/velocity/0", "'abs'");
}
