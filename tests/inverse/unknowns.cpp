// From the deck's unknowns to variables and back, transforms and priors.
#include "inverse/unknowns.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "fake_objective.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {
constexpr double inf = std::numeric_limits<double>::infinity();
}

TEST_CASE("A path with * is one variable for each pointer, in the deck's order, from the deck's values or the start") {
  const InverseDeck own(R"("unknowns": [ { "path": "/walls/y_min/segments/*/coefficient", "bounds": [0, 1] }, { "path": "/gravity/1" } ])");
  const Unknowns unknowns(own.deck);
  CHECK(unknowns.pointers() ==
        std::vector<std::string>{"/walls/y_min/segments/0/coefficient", "/walls/y_min/segments/1/coefficient", "/gravity/1"});
  CHECK(unknowns.space().start == Variables{0.25, 0.75, -9});
  CHECK(unknowns.space().lower == Variables{0, 0, -inf});
  CHECK(unknowns.space().upper == Variables{1, 1, inf});
  CHECK(unknowns.space().scale == Variables{1, 1, 9});
  CHECK(unknowns.label(1) == "/walls/y_min/segments/1/coefficient");
  CHECK(unknowns.space().projected({-0.5, 0.5, -100}) == Variables{0, 0.5, -100});
  const InverseDeck given(R"("unknowns": [ { "path": "/walls/y_min/segments/*/coefficient", "start": [0.1, 0.2] } ])");
  CHECK(Unknowns(given.deck).space().start == Variables{0.1, 0.2});
}

TEST_CASE("Values get into the deck through its own reader") {
  const InverseDeck own(R"("unknowns": [ { "path": "/walls/y_min/segments/*/coefficient", "start": 0.5, "share": true } ])");
  const Unknowns unknowns(own.deck);
  CHECK(unknowns.size() == 1);
  CHECK(unknowns.label(0) == "/walls/y_min/segments/*/coefficient");
  const deck::Deck changed = deck::with_assignments(own.deck, assignments(unknowns.values({1.0 / 3})));
  for (const deck::Segment& segment : changed.walls.at("y_min").segments) CHECK(segment.coefficient == 1.0 / 3);
  const Values gradient{{"/walls/y_min/segments/0/coefficient", {2}}, {"/walls/y_min/segments/1/coefficient", {3}}};
  CHECK(unknowns.gradient({0.5}, gradient) == Variables{5});
  CHECK_THROWS_AS(deck::with_assignments(own.deck, assignments(unknowns.values({-0.1}))), DeckError);
}

TEST_CASE("Transforms: values, bounds and the chain rule") {
  const InverseDeck own(R"("unknowns": [ { "path": "/materials/water/density", "bounds": [500, 2000], "transform": "log" },
                                         { "path": "/walls/y_min/segments/0/coefficient", "bounds": [0.2, 0.7], "transform": "logit" } ])");
  const Unknowns unknowns(own.deck);
  const Variables start = unknowns.space().start;
  CHECK(start[0] == Approx(std::log(1000)));
  CHECK(start[1] == Approx(std::log(0.05 / 0.45)));
  CHECK(unknowns.space().lower[0] == Approx(std::log(500)));
  CHECK(unknowns.space().upper == Variables{std::log(2000), inf});
  CHECK(unknowns.space().lower[1] == -inf);
  const Values values = unknowns.values(start);
  CHECK(values.at("/materials/water/density")[0] == Approx(1000));
  CHECK(values.at("/walls/y_min/segments/0/coefficient")[0] == Approx(0.25));
  CHECK(unknowns.values({std::log(2000), 1e3}).at("/walls/y_min/segments/0/coefficient")[0] == 0.7);
  for (std::size_t i = 0; i < 2; ++i) {
    const double h = 1e-6;
    Variables above = start, below = start;
    above[i] += h;
    below[i] -= h;
    const std::string& pointer = unknowns.pointers()[i];
    const double difference = (unknowns.values(above).at(pointer)[0] - unknowns.values(below).at(pointer)[0]) / (2 * h);
    CHECK(unknowns.slopes(start)[i] == Approx(difference).epsilon(1e-8));
    Values gradient{{unknowns.pointers()[0], {0}}, {unknowns.pointers()[1], {0}}};
    gradient[pointer][0] = 4;
    CHECK(unknowns.gradient(start, gradient)[i] == Approx(4 * difference).epsilon(1e-8));
  }
}

TEST_CASE("A prior is half the square of its residual, of the number and not of the transformed variable") {
  const InverseDeck own(R"("unknowns": [ { "path": "/gravity/0" },
      { "path": "/materials/water/density", "transform": "log", "prior": { "mean": 900, "deviation": 50 } } ])");
  const Unknowns unknowns(own.deck);
  const Variables start = unknowns.space().start;
  CHECK(unknowns.prior_variables() == std::vector<std::size_t>{1});
  CHECK(unknowns.prior_residuals(start)[0] == Approx(2));
  Variables gradient{0, 0};
  unknowns.add_prior_gradient(start, gradient);
  CHECK(gradient[0] == 0);
  CHECK(gradient[1] == Approx(2.0 / 50 * 1000));
}

TEST_CASE("A network is a block of its weights, which the deck takes") {
  const InverseDeck own(R"("unknowns": [ { "path": "/gravity/1" }, { "path": "/bodies/*/velocity/0/mlp" } ])",
                        R"([ { "mlp": { "inputs": ["y"], "hidden": [3] } }, 0 ])");
  const Unknowns unknowns(own.deck);
  CHECK(unknowns.size() == 1 + 10);
  const std::string pointer = "/bodies/0/velocity/0/mlp";
  CHECK(unknowns.label(4) == pointer + "[3]");
  Variables u = unknowns.space().start;
  CHECK(u[1] != 0);  // drawn from the seed
  u[10] = 2.5;
  const deck::Deck changed = deck::with_assignments(own.deck, assignments(unknowns.values(u)));
  const auto& components = std::get<std::vector<deck::Component>>(changed.bodies[0].velocity);
  CHECK(std::get<deck::Mlp>(components[0]).weights == Variables(u.begin() + 1, u.end()));
  CHECK(Unknowns(changed).space().start == u);  // and starts from them where it has them
}

TEST_CASE("Velocities of particles from a file are one block: bounds, transform and prior hold for each, and the model takes them") {
  const std::string pointer = "/bodies/0/velocity/particles";
  const auto deck_of = [](const std::string& unknown) {
    return std::make_unique<InverseDeck>(R"("unknowns": [ { "path": "/bodies/*/velocity/particles")" + unknown + " } ]",
                                         R"({ "particles": { "file": "v.csv" } })");
  };
  const auto own = deck_of(R"(, "prior": { "deviation": 0.5 })");
  CHECK_THROWS_AS(Unknowns(own->deck), IoError);  // there is no file yet
  std::string table = "id,vx,vy\n";
  for (int id = 59; id >= 0; --id) table += std::to_string(id) + "," + std::to_string(id) + ",-3\n";  // in any order
  std::ofstream(own->folder() + "/v.csv") << table;
  const Unknowns unknowns(own->deck);
  REQUIRE(unknowns.size() == 120);
  CHECK(unknowns.label(14) == pointer + "[14]");
  Variables u = unknowns.space().start;
  CHECK(u[14] == 7);
  CHECK(u[15] == -3);
  double square = 0;
  for (const double v : u) square += v * v;
  CHECK(unknowns.space().scale[14] == Approx(std::sqrt(square / 120)));

  // A prior without a mean holds each value near its own start.
  CHECK(unknowns.prior_residuals(u) == Variables(120, 0.0));
  u[14] = 9;
  CHECK(unknowns.prior_residuals(u)[14] == 4);
  Variables gradient(120, 0.0);
  unknowns.add_prior_gradient(u, gradient);
  CHECK(gradient[14] == 8);
  CHECK(gradient[15] == 0);

  const Values values = unknowns.values(u);
  CHECK(assignments(values).empty());
  const deck::Deck plain = with_values(own->deck, values);
  CHECK(build_model(plain).bodies[0].initial.velocity[7] == Point{7, -3, 0});
  CHECK(build_model(plain, values).bodies[0].initial.velocity[7] == Point{9, -3, 0});

  const auto bounded = deck_of(R"(, "bounds": [-2, 60], "transform": "logit")");
  std::ofstream(bounded->folder() + "/v.csv") << table;
  CHECK_THROWS_WITH(Unknowns(bounded->deck), Catch::Contains("/inverse/unknowns/0/start") && Catch::Contains("velocity of particle 0: -3"));
}
