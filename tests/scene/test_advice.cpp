// Each piece of advice is given where it belongs, and nowhere else.
#include "scene/advice.hpp"

#include <catch2/catch.hpp>

#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {

/// Water half a metre deep: 3.1 m/s.
deck::Deck good_deck(int dim = 2) {
  deck::Deck deck = dim == 2 ? water_deck({0, 0}, {1, 1}, 0.1, box({0, 0}, {0.5, 0.5}))
                             : water_deck({0, 0, 0}, {1, 0.4, 1}, 0.1, box({0, 0, 0}, {0.5, 0.4, 0.5}));
  deck.gravity.assign(std::size_t(dim), 0.0), deck.gravity.back() = -10;
  std::get<deck::Newtonian>(deck.materials.at("water")).sound_speed = 31;
  return deck;
}

std::vector<std::string> advice_of(const deck::Deck& deck, double number = 0.4) {
  return advice(deck, build_model(deck), {number * 1e-3, 1e-3});
}

void check_only(const deck::Deck& deck, const std::string& text, double number = 0.4) {
  const std::vector<std::string> said = advice_of(deck, number);
  REQUIRE(said.size() == 1);
  CHECK_THAT(said[0], Catch::Contains(text) && Catch::Contains("docs/"));
}

}  // namespace

TEST_CASE("a good deck gets no advice") { CHECK(advice_of(good_deck()).empty()); }

TEST_CASE("advice on the sound speed") {
  deck::Deck deck = good_deck();
  std::get<deck::Newtonian>(deck.materials.at("water")).sound_speed = 10;
  check_only(deck, "is 3.2 times the speed of 3.082");
  std::get<deck::Newtonian>(deck.materials.at("water")).sound_speed = 300;
  check_only(deck, "3.8 times as many steps");
  deck.gravity = {0, 10};  // up is down: the height counts from the top
  check_only(deck, "is 67.9 times the speed of 4.416");
}

TEST_CASE("advice on the scheme, the step and the particles") {
  deck::Deck deck = good_deck();
  deck.method.transfer = deck::Transfer::pic;
  check_only(deck, "kinematic viscosity of about 6.3 m²/s");
  deck.method.transfer = deck::Transfer::flip;
  CHECK(advice_of(deck).empty());
  deck.method.flip_fraction = 1;
  check_only(deck, "keeps 99 % of the particles' noise");
  deck = good_deck();
  deck.method.basis = deck::Basis::linear;
  CHECK(advice_of(deck, 0.4).size() == 2);
  check_only(deck, "42 % off", 0.25);
  deck = good_deck();
  deck.time.step = 1e-5;
  check_only(deck, "the fixed step is 0.01 of what", 0.01);
  deck = good_deck();
  deck.bodies[0].particles_per_cell = 1;
  check_only(deck, "has 1 particles per cell");
}

TEST_CASE("advice to leave out a dimension along which nothing varies") {
  deck::Deck deck = good_deck(3);
  check_only(deck, "nothing varies along y");
  deck.walls["y_max"] = {deck::ContactKind::no_slip, 0, {}, {}};
  CHECK(advice_of(deck).empty());
  deck.walls.clear();
  deck.bodies[0].velocity = std::vector<deck::Component>{std::string("y"), 0.0, 0.0};
  CHECK(advice_of(deck).empty());
  deck = good_deck(3);
  deck.bodies[0].shape = box({0, 0, 0}, {0.5, 0.2, 0.5});
  CHECK(advice_of(deck).empty());
}
