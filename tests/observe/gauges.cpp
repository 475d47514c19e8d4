// Gauges of clouds whose readings are known.
#include "observe/gauges.hpp"

#include <catch2/catch.hpp>
#include <set>

#include "clouds.hpp"
#include "core/error.hpp"
#include "observe/spline.hpp"

using namespace jaxmpm;
using testing::empty_model;
using testing::fill;
using testing::read;

namespace {

const Model flat = empty_model(2, {40, 20, 1}, 0.05);  // 2 m × 1 m
std::vector<BodySnapshot> pool(double depth) {
  return {fill(flat, 2, [=](const Point& x) { return x[1] < depth; })};
}

}  // namespace

TEST_CASE("the spline has unit weight and its step is its integral") {
  double sum = 0;
  for (int k = -2000; k < 2000; ++k) {
    const double r = (k + 0.5) / 1000;
    sum += spline(r) / 1000;
    CHECK(spline_step(r + 0.0005) == Approx(sum).margin(1e-6));
  }
  CHECK(sum == Approx(1).epsilon(1e-6));
}

TEST_CASE("height of a pool, also beside a wall") {
  for (const double at : {0.0, 0.03, 1.0, 2.0}) {
    const Sample sample = read(*make_gauge(deck::HeightGauge{{at}}, flat), pool(0.5));
    REQUIRE(sample.valid);
    CHECK(sample.values[0] == Approx(0.5).margin(1e-6));
  }
}

TEST_CASE("height takes what is connected to the ground") {
  const std::vector<BodySnapshot> layers{fill(flat, 2, [](const Point& x) { return x[1] < 0.3 || (x[1] > 0.6 && x[1] < 0.9); })};
  CHECK(read(*make_gauge(deck::HeightGauge{{1.0}}, flat), layers).values[0] == Approx(0.3).margin(1e-6));
  const std::vector<BodySnapshot> hanging{fill(flat, 2, [](const Point& x) { return x[1] > 0.6 && x[1] < 0.9; })};
  const Sample dry = read(*make_gauge(deck::HeightGauge{{1.0}}, flat), hanging);
  CHECK_FALSE(dry.valid);
}

TEST_CASE("height above the top of an obstacle, in 3D") {
  Model model = empty_model(3, {10, 10, 20}, 0.1);
  model.obstacles.push_back({"step", deck::ContactKind::slip, 0,
                             [](const Point& x) {
                               return SignedDistance{x[2] - 5, {0, 0, 1}};
                             },
                             nullptr});
  const std::vector<BodySnapshot> water{fill(model, 2, [](const Point& x) { return x[2] > 0.5 && x[2] < 1.2; })};
  CHECK(read(*make_gauge(deck::HeightGauge{{0.5, 0.5}}, model), water).values[0] == Approx(1.2).margin(1e-6));
}

TEST_CASE("pressure near a point of a linear field is the field's") {
  CHECK(read(*make_gauge(deck::PressureGauge{{1.0, 0.25}}, flat), pool(0.5)).values[0] == Approx(3.5));
  CHECK_FALSE(read(*make_gauge(deck::PressureGauge{{1.0, 0.8}}, flat), pool(0.5)).valid);
}

TEST_CASE("region means") {
  const Sample linear = read(*make_gauge(deck::RegionMeanGauge{"pressure", {0.5, 0.1}, {1.0, 0.3}}, flat), pool(0.5));
  CHECK(linear.values[0] == Approx(3 * 0.75 + 2 * 0.2));
  const Sample velocity = read(*make_gauge(deck::RegionMeanGauge{"velocity", {0.5, 0.1}, {1.0, 0.3}}, flat), pool(0.5));
  CHECK(velocity.values[0] == Approx(1));
  CHECK(velocity.values[1] == Approx(2));
  CHECK(read(*make_gauge(deck::RegionMeanGauge{"stress", {0.5, 0.1}, {1.0, 0.3}}, flat), pool(0.5)).values.size() == 6);
  CHECK_FALSE(read(*make_gauge(deck::RegionMeanGauge{"pressure", {0.5, 0.8}, {1.0, 0.9}}, flat), pool(0.5)).valid);
}

TEST_CASE("momentum and energy of a moving pool") {
  const auto water = pool(0.5);
  const double mass = 1000 * 2 * 0.5;
  const Sample momentum = read(*make_gauge(deck::MomentumGauge{}, flat), water);
  CHECK(momentum.values[0] == Approx(mass));
  CHECK(momentum.values[1] == Approx(2 * mass));
  const auto gauge = make_gauge(deck::EnergyGauge{}, flat);
  const Sample energy = read(*gauge, water);
  CHECK(energy.values[0] == Approx(0.5 * mass * 5));
  CHECK(energy.values[1] == Approx(mass * 10 * 0.25));
  CHECK(energy.values[2] == Approx(0.5 * 2 * 0.5));
  CHECK(energy.values[6] == 0);
  CHECK(gauge->channels()[0].components.size() == 7);
  const std::vector<double> first{energy.values[0] + 100, energy.values[1], energy.values[2], 0, 0, 0, 0};
  const Sample later = read(*gauge, water, {30, 20, 10}, &first);
  CHECK(later.values[3] == 30);
  CHECK(later.values[6] == Approx(40));  // the 100 J that are gone, less what the materials and walls account for
}

TEST_CASE("force on a wall is what the material exerts") {
  ContactForces forces;
  forces.face[2] = {1, 50, 0};  // y_min pushes the material up
  deck::ForceGauge wanted;
  wanted.wall = "y_min";
  const auto gauge = make_gauge(wanted, flat);
  CHECK(gauge->measure({{1, 0.1, 0.1, 0}, {}, forces, {}}, nullptr).values == std::vector<double>{-1, -50});
  CHECK_FALSE(gauge->measure({{0, 0, 0, 0}, {}, forces, {}}, nullptr).valid);
  wanted.wall = "z_min";
  CHECK_THROWS_AS(make_gauge(wanted, flat), DeckError);
  CHECK_THROWS_AS(make_gauge(deck::ForceGauge{"tower", ""}, flat), DeckError);
}

TEST_CASE("chosen particles, in the order asked for") {
  Model model = flat;
  for (std::uint32_t id = 0; id < 9; ++id) model.bodies[0].initial.id.push_back(id);
  const auto gauge = make_gauge(deck::ParticlesGauge{{7, 2}, {"position", "id", "plastic_strain"}}, model);
  const auto water = pool(0.5);
  const Sample sample = read(*gauge, water);
  REQUIRE(sample.values.size() == 8);
  CHECK(sample.values[0] == water[0].position[14]);
  CHECK(sample.values[3] == water[0].position[5]);
  CHECK(sample.values[4] == 7);
  CHECK(sample.values[5] == 2);
  CHECK(sample.values[6] == 0.25);
  CHECK_THROWS_WITH(make_gauge(deck::ParticlesGauge{{12}, {"id"}}, model), Catch::Contains("12"));
}

TEST_CASE("every field that a deck can name is known, and no other") {
  std::set<std::string> known;
  for (const OutputField& field : output_fields()) known.insert(field.name);
  CHECK(known == std::set<std::string>(deck::field_names().begin(), deck::field_names().end()));
  CHECK_THROWS_WITH(output_field("temperature"), Catch::Contains("velocity_gradient"));
}
