// Particle counts, ids, jitter, and what may not be seeded.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <set>

#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

TEST_CASE("dam_break_3d has 1,920,000 particles of the pool's mass, seeded within seconds") {
  const deck::Deck deck = water_deck({0, 0, 0}, {1, 0.5, 0.4}, 0.005, box({0, 0, 0}, {0.3, 0.5, 0.2}));
  const auto start = std::chrono::steady_clock::now();
  const Model model = build_model(deck);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("seeding 1.92 million particles: %.2f s\n", seconds.count());
  CHECK(particle_count(model) == 1920000);
  CHECK(seconds.count() < 10);  // a generous bound for a busy machine; alone it takes a tenth
  double mass = 0;
  for (const double m : model.bodies[0].initial.mass) mass += m;
  CHECK(mass == Approx(1000 * 0.3 * 0.5 * 0.2).epsilon(1e-9));
}

TEST_CASE("granular_cylinder has 2,712,960 particles within 0.1%, each of them counted by hand") {
  const deck::Shape column{deck::Cylinder{{0.5, 0.5, 0}, {0.5, 0.5, 0.075}, 0.15}};
  const std::size_t count = particle_count(build_model(water_deck({0, 0, 0}, {1, 1, 0.1}, 0.0025, column)));
  std::size_t in_plan = 0;  // lattice of half cells, radius 120
  for (int i = -120; i < 120; ++i)
    for (int j = -120; j < 120; ++j) in_plan += (2 * i + 1) * (2 * i + 1) + (2 * j + 1) * (2 * j + 1) < 240 * 240;
  CHECK(count == 60 * in_plan);
  CHECK(count == Approx(2712960).epsilon(1e-3));
}

TEST_CASE("Lattice order: ids run with the last axis fastest, over bodies in deck order") {
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {2, 1}));
  deck.bodies.push_back(deck.bodies[0]);
  deck.bodies[1].name = "other";
  deck.bodies[1].shape = box({2, 0}, {3, 2});
  const Model model = build_model(deck);
  REQUIRE(model.bodies[0].initial.id.size() == 8);
  REQUIRE(model.bodies[1].initial.id.size() == 8);
  CHECK(model.bodies[0].initial.position[0] == Point{0.25, 0.25, 0});
  CHECK(model.bodies[0].initial.position[1] == Point{0.25, 0.75, 0});
  CHECK(model.bodies[0].initial.position[2] == Point{0.75, 0.25, 0});
  CHECK(model.bodies[1].initial.id.front() == 8);
  CHECK(model.bodies[1].initial.id.back() == 15);
}

TEST_CASE("A face through lattice places belongs to one side only") {
  // Faces at 2.25 cells run through places of the 2 × 2 lattice.
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {2.25, 4}));
  deck.bodies.push_back(deck.bodies[0]);
  deck.bodies[1].name = "other";
  deck.bodies[1].shape = box({2.25, 0}, {4, 4});
  CHECK(particle_count(build_model(deck)) == 64);
}

TEST_CASE("Spacing instead of particles per cell, and volumes of round bodies") {
  deck::Deck deck = water_deck({0, 0, 0}, {2, 2, 2}, 0.1, {deck::Sphere{{1, 1, 1}, 0.6}});
  deck.bodies[0].spacing = 0.03;
  const double volume = 4.0 / 3 * M_PI * 0.6 * 0.6 * 0.6;
  CHECK(particle_count(build_model(deck)) * std::pow(0.03, 3) == Approx(volume).epsilon(0.01));
  deck.bodies[0].shape = {deck::Cylinder{{0.5, 0.5, 0.5}, {1.4, 1.2, 1.5}, 0.3}};
  const double length = std::sqrt(0.9 * 0.9 + 0.7 * 0.7 + 1.0);
  CHECK(particle_count(build_model(deck)) * std::pow(0.03, 3) == Approx(M_PI * 0.09 * length).epsilon(0.01));
  deck::Deck plane = water_deck({0, 0}, {2, 2}, 0.02, {deck::Polygon{{{0.2, 0.2}, {1.8, 0.2}, {0.2, 1.4}}}});
  CHECK(particle_count(build_model(plane)) * 1e-4 == Approx(0.5 * 1.6 * 1.2).epsilon(0.01));
}

TEST_CASE("Union and difference") {
  const deck::Shape both{deck::Union{{box({0, 0}, {2, 2}), box({1, 1}, {3, 3})}}};
  CHECK(particle_count(build_model(water_deck({0, 0}, {4, 4}, 1, both))) == 4 * 7);
  const deck::Shape rest{deck::Difference{{box({0, 0}, {3, 3}), box({1, 1}, {2, 9})}}};
  CHECK(particle_count(build_model(water_deck({0, 0}, {4, 4}, 1, rest))) == 4 * 7);
}

TEST_CASE("Jitter is bounded, the same for the same seed, and stays inside the shape") {
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 0.1, {deck::Sphere{{2, 2}, 1.5}});
  const Model plain = build_model(deck);
  deck.bodies[0].jitter = deck::Jitter{0.8, 7};
  const Model a = build_model(deck), b = build_model(deck);
  deck.bodies[0].jitter->seed = 8;
  const Model c = build_model(deck);
  const auto& places = a.bodies[0].initial.position;
  REQUIRE(places.size() == plain.bodies[0].initial.position.size());
  CHECK(places == b.bodies[0].initial.position);
  CHECK(places != c.bodies[0].initial.position);
  double largest = 0, sum = 0, radius = 0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Point move = places[p] - plain.bodies[0].initial.position[p];
    largest = std::max({largest, std::abs(move[0]), std::abs(move[1])});
    sum += move[0];
    radius = std::max(radius, norm(places[p] - Point{20, 20, 0}));
  }
  CHECK(largest <= 0.8 * 0.25);
  CHECK(largest > 0.79 * 0.25);
  CHECK(std::abs(sum / places.size()) < 0.01);
  CHECK(radius < 15);
}

TEST_CASE("Jitter does not depend on the bodies that come later") {
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {2, 2}));
  deck.bodies[0].jitter = deck::Jitter{1, 3};
  const Model alone = build_model(deck);
  deck.bodies.push_back(deck.bodies[0]);
  deck.bodies[1].shape = box({2, 2}, {4, 4});
  CHECK(build_model(deck).bodies[0].initial.position == alone.bodies[0].initial.position);
}

TEST_CASE("Particles inside an obstacle are left out, with a notice") {
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {4, 2}));
  deck.obstacles.push_back({"sill", box({1, 0}, {2, 1}), deck::ContactKind::separate, 0});
  const Model model = build_model(deck);
  CHECK(particle_count(model) == 32 - 4);
  REQUIRE(model.notices.size() == 1);
  CHECK(model.notices[0].find("4 of its 32 particles") != std::string::npos);
  CHECK(model.bodies[0].initial.id.back() == 27);
  deck.obstacles[0].shape = box({0, 0}, {4, 4});
  CHECK(problem_pointer(deck) == "/bodies/0/shape");
}

TEST_CASE("What cannot be seeded is refused by name and place") {
  std::string message;
  deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, box({0, 0}, {2, 2}));
  deck.bodies.push_back(deck.bodies[0]);
  deck.bodies[1].name = "other";
  deck.bodies[1].shape = box({1.5, 1.5}, {3, 3});
  CHECK(problem_pointer(deck, &message) == "/bodies/1");
  CHECK(message.find("'pool' and 'other' overlap") != std::string::npos);

  // A coarse lattice in a fine body: its particles decide, whichever comes first.
  deck.bodies[1].shape = box({0.4, 0.4}, {0.6, 0.6});
  deck.bodies[1].spacing = 0.1;
  CHECK(problem_pointer(deck) == "/bodies/1");

  deck.bodies[1].shape = box({3, 3}, {4.5, 4});
  CHECK(problem_pointer(deck, &message) == "/bodies/1/shape");
  CHECK(message.find("x_max: to 4.5 m") != std::string::npos);
  deck.bodies[1].shape = {deck::Difference{{box({-1, 3}, {1, 4}), box({-2, 2}, {0, 5})}}};
  CHECK(problem_pointer(deck).empty());  // what sticks out is taken away
  deck.bodies[1].shape = {deck::Difference{{box({-1, 3}, {1, 4}), box({-2, 2}, {-0.5, 5})}}};
  CHECK(problem_pointer(deck) == "/bodies/1/shape");

  deck.bodies[1].shape = {deck::Sphere{{3, 3}, 0.1}};
  deck.bodies[1].spacing.reset();
  CHECK(problem_pointer(deck, &message) == "/bodies/1/shape");
  CHECK(message.find("holds no particle") != std::string::npos);
  deck.bodies[1].particles_per_cell = 5;
  CHECK(problem_pointer(deck) == "/bodies/1/particles_per_cell");
}

TEST_CASE("Ten kilometres from the origin the model has the same bits") {
  const auto scene = [](double east, double north) {
    deck::Deck deck = water_deck({east, north}, {east + 1.6, north + 0.4}, 0.01, box({east, north + 0.1}, {east + 0.5, north + 0.4}));
    deck.bodies[0].initial_stress.kind = deck::InitialStress::Kind::hydrostatic;
    deck.bodies.push_back(deck.bodies[0]);
    deck.bodies[1].shape = {deck::Polygon{{{east + 0.6, north + 0.013}, {east + 1.2, north + 0.017}, {east + 0.9, north + 0.339}}}};
    deck.bodies[1].jitter = deck::Jitter{0.5, 2};
    deck.obstacles.push_back({"ball", {deck::Sphere{{east + 0.45, north + 0.2}, 0.077}}, deck::ContactKind::separate, 0});
    deck.walls["y_min"] = {deck::ContactKind::friction, 0, {{east + 0.4, 0.5}, {east + 1.6, 0.1}}, {}};
    return build_model(deck);
  };
  const Model here = scene(0, 0), there = scene(10000, 10000);
  for (int b = 0; b < 2; ++b) {
    const BodyState &a = here.bodies[b].initial, &c = there.bodies[b].initial;
    CHECK(a.position == c.position);
    CHECK(a.mass == c.mass);
    CHECK(a.compression == c.compression);
    CHECK(a.stress == c.stress);
  }
  CHECK(here.faces[2].to == there.faces[2].to);
  for (double x = 0; x < 160; x += 7.3)
    for (double y = 0; y < 40; y += 3.1) {
      const SignedDistance a = here.obstacles[0].signed_distance({x, y, 0}), c = there.obstacles[0].signed_distance({x, y, 0});
      CHECK((a.distance == c.distance && a.normal == c.normal));
    }
}

TEST_CASE("Points of a file stand where the file says, with its volumes") {
  const int dim = GENERATE(2, 3);
  const deck::Numbers low(std::size_t(dim), 1.0), high(std::size_t(dim), 3.0);
  const deck::Deck lattice = water_deck(deck::Numbers(std::size_t(dim), 0.0), deck::Numbers(std::size_t(dim), 4.0), 0.5, box(low, high));
  const Model expected = build_model(lattice);
  std::string rows = dim == 2 ? "# a comment\nvolume,y,x\n" : "x,y,z,volume\n";
  for (const Point& place : expected.bodies[0].initial.position) {
    const std::string volume = std::to_string(std::pow(0.25, dim));
    const auto metres = [&](int d) { return std::to_string(0.5 * place[std::size_t(d)]); };
    rows +=
        dim == 2 ? volume + "," + metres(1) + "," + metres(0) + "\n" : metres(0) + "," + metres(1) + "," + metres(2) + "," + volume + "\n";
  }
  const TemporaryFile file("points.csv", rows);
  deck::Deck deck = lattice;
  deck.bodies[0].shape.kind = deck::Points{file.path()};
  const Model model = build_model(deck);
  CHECK(model.bodies[0].initial.id == expected.bodies[0].initial.id);
  CHECK(model.bodies[0].initial.position == expected.bodies[0].initial.position);
  CHECK(model.bodies[0].initial.mass == expected.bodies[0].initial.mass);

  deck.bodies.push_back(lattice.bodies[0]);  // on a lattice, and over some of the points
  deck.bodies[1].name = "other", deck.bodies[1].shape = box(deck::Numbers(std::size_t(dim), 2.0), high);
  std::string message;
  CHECK(problem_pointer(deck, &message) == "/bodies/0/shape/points/file");
  CHECK_THAT(message, Catch::Contains("inside body 'other'") && Catch::Contains("line "));
}

TEST_CASE("Points of a file that cannot be particles are refused with their line") {
  const auto refusal = [](const std::string& rows) {
    const TemporaryFile file("points.csv", rows);
    deck::Deck deck = water_deck({0, 0}, {4, 4}, 1, {deck::Points{file.path()}});
    std::string message;
    CHECK(problem_pointer(deck, &message) == "/bodies/0/shape/points/file");
    return message;
  };
  CHECK_THAT(refusal("x,y,volume\n1,1,0.25\n1,5,0.25\n"), Catch::Contains("line 3") && Catch::Contains("outside the domain"));
  CHECK_THAT(refusal("x,y,volume\n1,1,0\n"), Catch::Contains("line 2") && Catch::Contains("above 0"));
  CHECK_THAT(refusal("x,y,volume\n"), Catch::Contains("no row") || Catch::Contains("no particle"));
  CHECK_THAT(refusal("x,y,z,volume\n1,1,1,0.25\n"), Catch::Contains("column z"));
  CHECK_THAT(refusal("x,y,volume\n1,1,0.25\n2,1,0.25\n1,1,0.25\n"), Catch::Contains("line 4") && Catch::Contains("in line 2"));
  CHECK_THAT(refusal("x,y,volume\n1,1,250\n"), Catch::Contains("line 2") && Catch::Contains("two cells"));
  CHECK_THAT(refusal("x,y\n1,1\n"), Catch::Contains("volume"));
  CHECK_THAT(refusal("x,y,volume\n1,nan,0.25\n"), Catch::Contains("line 2"));
}
