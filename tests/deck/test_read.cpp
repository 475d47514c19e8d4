// What the reader makes of good decks: values, defaults, --set, and the resolved text.
#include <catch2/catch.hpp>

#include "example.hpp"

using namespace jaxmpm;
using deck::read_deck;

namespace {

deck::Deck read_text(const std::string& text, const std::vector<std::string>& assignments = {}) {
  const test::Folder here;
  return read_deck(here.file("scene.json", text), assignments);
}

std::vector<Problem> problems_of(const std::vector<std::string>& assignments) {
  try {
    read_text(test::small_deck, assignments);
  } catch (const DeckError& error) {
    return error.problems;
  }
  return {};
}

}  // namespace

TEST_CASE("the automatic step is shorter with linear splines, unless the deck says how long") {
  const auto cfl = [](const std::vector<std::string>& assignments) { return read_text(test::small_deck, assignments).time.cfl; };
  CHECK(cfl({R"(/method={"basis": "cubic"})"}) == 0.4);
  CHECK(cfl({R"(/method={"basis": "linear"})"}) == 0.25);
  CHECK(cfl({R"(/method={"basis": "linear"})", "/time/cfl=0.35"}) == 0.35);
}

TEST_CASE("keys that are not given have their defaults") {
  const deck::Deck d = read_text(test::small_deck);
  CHECK(d.dimension() == 2);
  CHECK(d.title.empty());
  CHECK(!d.time.step);
  CHECK(d.time.cfl == 0.4);
  CHECK(d.method.transfer == deck::Transfer::apic);
  CHECK(d.method.basis == deck::Basis::quadratic);
  CHECK(d.method.gradient == deck::GradientForm::spline);
  CHECK(d.method.precision == deck::Precision::f64);
  const auto& water = std::get<deck::Newtonian>(d.materials.at("water"));
  CHECK(water.viscosity == 0);
  CHECK(!water.tension_limit);
  CHECK(d.bodies.at(0).particles_per_cell == 4);
  const auto& velocity = std::get<std::vector<deck::Component>>(d.bodies[0].velocity);
  REQUIRE(velocity.size() == 2);
  for (const deck::Component& component : velocity) CHECK(std::get<double>(component) == 0);
  CHECK(d.bodies[0].initial_stress.kind == deck::InitialStress::Kind::none);
  CHECK(!d.bodies[0].jitter);
  CHECK(d.output.directory == "out/scene");
  CHECK(d.output.gauge_interval == 0.05);
  CHECK(d.output.formats == std::vector<std::string>{"hdf5", "vtk"});
  CHECK(d.output.fields == std::vector<std::string>{"velocity", "pressure"});
  CHECK(d.output.checkpoint_interval_minutes == 10);
  CHECK(d.inverse.empty());
  CHECK(d.as_given == test::small_deck);
}

TEST_CASE("every key of the format is read") {
  const deck::Deck d = read_text(test::full_deck);
  CHECK(d.dimension() == 3);
  CHECK(d.method.flip_fraction == 0.95);
  CHECK(d.method.gradient == deck::GradientForm::mls);
  const auto& sand = std::get<deck::DruckerPrager>(d.materials.at("sand"));
  CHECK(*sand.bulk_modulus == 1e6);
  CHECK(!sand.youngs_modulus);
  CHECK(sand.tension_cutoff == 50);
  REQUIRE(d.bodies.size() == 4);
  CHECK(std::get<std::string>(std::get<std::vector<deck::Component>>(d.bodies[0].velocity)[0]) == "u0 * z");
  CHECK(std::get<deck::Difference>(d.bodies[0].shape.kind).shapes.size() == 2);
  CHECK(*d.bodies[1].spacing == 0.02);
  CHECK(!d.bodies[1].particles_per_cell);
  CHECK(d.bodies[1].initial_stress.k0 == 0.4);
  CHECK(d.bodies[1].jitter->seed == 7);
  const auto& layer = std::get<deck::Layer>(d.bodies[1].shape.kind);
  CHECK(layer.height_map.vertical_scale == 2);
  CHECK(std::get<0>(layer.area)[1] == deck::Numbers{0.5, 0});
  CHECK(d.bodies[2].initial_stress.surface->point == deck::Numbers{0, 0, 0.1});
  const auto& network = std::get<deck::Mlp>(std::get<std::vector<deck::Component>>(d.bodies[2].velocity)[1]);
  CHECK(network.hidden == std::vector<int>{8, 8});
  CHECK(network.activation == "tanh");
  CHECK(std::get<deck::Mesh>(std::get<deck::Union>(d.bodies[2].shape.kind).shapes[1].kind).offset == deck::Numbers{0, 0, 0});
  CHECK(std::get<deck::ParticleFile>(d.bodies[3].velocity).file == "v.csv");
  CHECK(d.walls.at("z_min").segments[1].coefficient == 0.1);
  CHECK(d.obstacles[1].kind == deck::ContactKind::separate);
  CHECK(!std::get<deck::FrontGauge>(d.gauges.at("front")).quantile);
  CHECK(std::get<deck::FrontGauge>(d.gauges.at("spread")).smooth == 0.05);
  CHECK(std::get<deck::ForceGauge>(d.gauges.at("push")).wall == "x_max");
  CHECK(std::get<deck::ParticlesGauge>(d.gauges.at("some")).ids == std::vector<std::int64_t>{1, 5});
  CHECK(d.inverse.find("\"lbfgs\"") != std::string::npos);
}

TEST_CASE("the resolved deck reads back as the same deck") {
  for (const char* text : {test::small_deck, test::full_deck}) {
    const deck::Deck first = read_text(text);
    const deck::Deck second = read_text(first.resolved);
    CHECK(second.resolved == first.resolved);
    CHECK(second.inverse == first.inverse);
  }
  CHECK(read_text(test::small_deck).resolved.find("\"tension_limit\": \"none\"") != std::string::npos);
}

TEST_CASE("a deck that was read takes other values without its file") {
  const deck::Deck first = read_text(test::full_deck, {"/time/end=0.75"});
  const deck::Deck second = deck::with_assignments(first, {"/materials/water/density=990.5"});
  CHECK(second.time.end == 0.75);
  CHECK(std::get<deck::Newtonian>(second.materials.at("water")).density == 990.5);
  CHECK(second.path == first.path);
  CHECK(second.as_given == first.as_given);
  CHECK_THROWS_AS(deck::with_assignments(first, {"/materials/water/density=-1"}), DeckError);
}

TEST_CASE("assignments (--set) change and add keys before the check") {
  const deck::Deck d =
      read_text(test::small_deck, {"/time/end=0.5", "/bodies/0/name=lake", "/method={\"basis\": \"cubic\"}", "/method/transfer=flip",
                                   "/bodies/0/shape/box/max/0=0.4", "/walls={\"x_min\": {\"kind\": \"no_slip\"}}"});
  CHECK(d.time.end == 0.5);
  CHECK(d.bodies[0].name == "lake");
  CHECK(d.method.basis == deck::Basis::cubic);
  CHECK(d.method.transfer == deck::Transfer::flip);
  CHECK(std::get<deck::Box>(d.bodies[0].shape.kind).max == deck::Numbers{0.4, 0.3});
  CHECK(d.walls.at("x_min").kind == deck::ContactKind::no_slip);
  CHECK(d.resolved.find("\"lake\"") != std::string::npos);
  CHECK(d.as_given == test::small_deck);
}

TEST_CASE("an assignment (--set) that makes no sense is a problem of the deck") {
  const auto only = [](const std::string& assignment) {
    const std::vector<Problem> problems = problems_of({assignment});
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].line == 0);
    return problems[0].pointer + ": " + problems[0].message;
  };
  using Catch::Contains;
  CHECK_THAT(only("time/end=1"), Contains("write /pointer=value"));
  CHECK_THAT(only("/time/end"), Contains("write /pointer=value"));
  CHECK_THAT(only("/method/basis=cubic"), Contains("there is no /method"));
  CHECK_THAT(only("/bodies/3=1"), Contains("a list of 1"));
  CHECK_THAT(only("/title/x=1"), Contains("there is no /title"));
  CHECK_THAT(only("/time/ent=1"), Contains("/time/ent: unknown key; did you mean \"end\""));
  CHECK_THAT(only("/time/end=1e999"), Contains("expected a number (s), found the string"));
  CHECK_THAT(only("/time/end=NaN"), Contains("expected a number (s), found the string"));
  CHECK_THAT(only("/walls={\"x_min\": {}, \"x_min\": {}}"), Contains("given twice"));
}

TEST_CASE("an extent that is whole cells up to rounding is accepted") {
  CHECK_NOTHROW(read_text(test::small_deck, {"/domain/max=[0.3, 0.7]"}));
  CHECK_NOTHROW(read_text(test::small_deck, {"/domain/max/0=1.00000005"}));
  CHECK_THROWS_AS(read_text(test::small_deck, {"/domain/max/0=1.000001"}), DeckError);
}
