// Velocities, walls, switches, and the decks of inputs/.
#include <catch2/catch.hpp>
#include <chrono>
#include <map>

#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

TEST_CASE("Velocity by components in deck coordinates") {
  deck::Deck deck = water_deck({10, 20}, {14, 24}, 1, box({10, 20}, {12, 22}));
  deck.parameters["u0"] = 2;
  deck.bodies[0].velocity = std::vector<deck::Component>{std::string("u0*(22-y)+x"), -1.5};
  const BodyState state = build_model(deck).bodies[0].initial;
  CHECK(state.velocity[1][0] == Approx(2 * (22 - 20.75) + 10.25));
  CHECK(state.velocity[1][1] == -1.5);
  deck.bodies[0].velocity = std::vector<deck::Component>{0.0, std::string("v0*x")};
  std::string message;
  CHECK(problem_pointer(deck, &message) == "/bodies/0/velocity/1");
  CHECK(message.find("unknown name 'v0'") != std::string::npos);
  deck.bodies[0].velocity = std::vector<deck::Component>{std::string("1/(x-10.25)"), 0.0};
  CHECK(problem_pointer(deck, &message) == "/bodies/0/velocity/0");
  CHECK(message.find("(10.25, 20.25) m") != std::string::npos);
}

TEST_CASE("Velocity from a file names every particle once") {
  deck::Deck deck = water_deck({0, 0}, {2, 2}, 1, box({0, 0}, {1, 1}));
  const auto build = [&](const std::string& rows) {
    const TemporaryFile file("velocity.csv", "# of four particles\nid,vx,vy\n" + rows);
    deck.bodies[0].velocity = deck::ParticleFile{file.path()};
    return build_model(deck);
  };
  const Model model = build("3,0.5,1\n0,1,2\n1,3,4\n2,5,6\n17,9,9\n");
  CHECK(model.bodies[0].initial.velocity[3] == Point{0.5, 1, 0});
  CHECK(model.bodies[0].initial.velocity[0] == Point{1, 2, 0});
  CHECK_THROWS_WITH(build("0,1,2\n1,3,4\n2,5,6\n"), Catch::Contains("no row for particle 3"));
  CHECK_THROWS_WITH(build("0,1,2\n1,3,4\n1,5,6\n"), Catch::Contains("line 5") && Catch::Contains("twice"));
  CHECK_THROWS_WITH(build("0,1,2\n1,nan,4\n"), Catch::Contains("line 4") && Catch::Contains("not a finite number"));
}

TEST_CASE("Walls in cells") {
  deck::Deck deck = water_deck({1, 0}, {3, 4}, 0.5, box({1, 0}, {2, 2}));
  deck.walls["y_min"] = {deck::ContactKind::friction, 0, {{1.5, 0.5}, {3, 0.1}}, {}};
  deck.walls["x_max"] = {deck::ContactKind::friction, 0.3, {}, {}};
  deck.walls["x_min"] = {deck::ContactKind::no_slip, 0, {}, {}};
  const Model model = build_model(deck);
  CHECK(model.faces[0].kind == deck::ContactKind::no_slip);
  CHECK(model.faces[1].coefficient == std::vector<double>{0.3});
  CHECK(model.faces[2].to == std::vector<double>{1, 4});
  CHECK(model.faces[2].coefficient == std::vector<double>{0.5, 0.1});
  CHECK(model.faces[2].segment_axis == 0);
  CHECK(model.faces[3].kind == deck::ContactKind::slip);
}

TEST_CASE("What gauges and output ask for") {
  deck::Deck deck = water_deck({0, 0}, {2, 2}, 1, box({0, 0}, {1, 1}));
  CHECK_FALSE(build_model(deck).record_velocity_gradient);
  CHECK_FALSE(build_model(deck).account_energy);
  deck.gauges["a"] = deck::EnergyGauge{};
  deck.gauges["b"] = deck::ParticlesGauge{{1}, {"velocity_gradient"}};
  CHECK(build_model(deck).record_velocity_gradient);
  CHECK(build_model(deck).account_energy);
  deck.gauges.clear();
  deck.output.fields = std::vector<std::string>{"velocity", "velocity_gradient"};
  CHECK(build_model(deck).record_velocity_gradient);
}

namespace {

/// Builds a deck of inputs/ and prints what it took; 0 where it fails.
std::size_t built_count(const std::filesystem::path& path) {
  try {
    const deck::Deck deck = deck::read_deck(path.string());
    const auto start = std::chrono::steady_clock::now();
    const Model model = build_model(deck);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%-28s %9zu particles, %.2f s\n", path.stem().c_str(), particle_count(model), seconds.count());
    for (const std::string& notice : model.notices) std::printf("  %s\n", notice.c_str());
    return particle_count(model);
  } catch (const Error& error) {
    FAIL_CHECK(error.what());
    return 0;
  }
}

}  // namespace

TEST_CASE("Every deck of inputs/ builds and the large ones have the issue's particle counts") {
  const std::map<std::string, std::size_t> counts{
      {"dam_break_3d", 1920000}, {"dam_break_friction", 6000}, {"granular_cylinder", 2712960}, {"granular_column_3d", 2408448}};
  for (const auto& entry : std::filesystem::directory_iterator(JAXMPM_SOURCE_DIR "/inputs")) {
    if (entry.path().extension() != ".json") continue;
    INFO(entry.path().string());
    const std::size_t count = built_count(entry.path());
    const auto expected = counts.find(entry.path().stem().string());
    if (expected != counts.end()) CHECK(count == Approx(expected->second).epsilon(1e-3));
  }
}

TEST_CASE("An obstacle that holds no node of the grid is told") {
  const auto notices = [](const deck::Shape& shape) {
    deck::Deck deck = water_deck({0, 0}, {4, 4}, 0.5, box({0, 0}, {1, 1}));
    deck.obstacles.push_back({"plate", shape});
    return build_model(deck).notices;
  };
  CHECK(notices(box({2, 0}, {2.5, 4})).empty());
  CHECK(notices(box({2, 0}, {2.1, 4})).empty());  // a face on nodes
  REQUIRE(notices(box({2.1, 0}, {2.4, 4})).size() == 1);
  CHECK_THAT(notices(box({2.1, 0}, {2.4, 4}))[0], Catch::Contains("'plate'") && Catch::Contains("no node"));
  CHECK(notices(box({5, 0}, {6, 4})).size() == 1);
}
