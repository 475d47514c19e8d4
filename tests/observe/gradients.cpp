// Derivatives of gauges against central differences of their readings, over clouds that lie at random, also at walls.
#include <catch2/catch.hpp>

#include "clouds.hpp"
#include "core/error.hpp"
#include "fields/random.hpp"

using namespace jaxmpm;
using testing::empty_model;
using testing::fill;
using testing::read;

namespace {

/// A heap against the lower end of the first axis, every number of it moved at random.
BodySnapshot heap(const Model& model, std::uint64_t seed) {
  const double length = model.cells[0] * model.cell_size, height = model.cells[model.dim - 1] * model.cell_size;
  BodySnapshot body = fill(model, 2, [&](const Point& x) {
    return (x[0] - model.domain_min[0]) / (0.7 * length) + (x[model.dim - 1] - model.domain_min[model.dim - 1]) / (0.7 * height) < 1;
  });
  RandomStream random(seed);
  for (double& x : body.position) x += 0.2 * model.cell_size * (random.uniform() - 0.5);
  for (double& v : body.velocity) v += random.normal();
  for (double& m : body.mass) m *= 0.9 + 0.2 * random.uniform();
  for (double& rho : body.density) rho *= 0.9 + 0.2 * random.uniform();
  for (double& s : body.stress) s = 100 * random.normal();
  for (double& e : body.plastic_strain) e = random.uniform();
  return body;
}

/// Pressure is what the gauge reads, stress what it is differentiated by.
void set_pressure(BodySnapshot& body) {
  for (std::size_t p = 0; p < body.id.size(); ++p)
    body.pressure[p] = -(body.stress[6 * p] + body.stress[6 * p + 1] + body.stress[6 * p + 2]) / 3;
}

/// Σ seeds · values of a gauge.
double weighted(const Gauge& gauge, std::vector<BodySnapshot> bodies, const std::vector<double>& seeds) {
  for (BodySnapshot& body : bodies) set_pressure(body);
  const Sample sample = read(gauge, bodies);
  REQUIRE(sample.valid);
  double sum = 0;
  for (std::size_t k = 0; k < seeds.size(); ++k) sum += seeds[k] * sample.values[k];
  return sum;
}

struct Differentiated {
  std::vector<double> BodySnapshot::*field;
  double step;  // of the central difference, in the field's unit
};
const std::vector<Differentiated> all_fields{{&BodySnapshot::position, 1e-6}, {&BodySnapshot::velocity, 1e-4},
                                             {&BodySnapshot::mass, 2e-5},     {&BodySnapshot::density, 1e-1},
                                             {&BodySnapshot::stress, 1e-2},   {&BodySnapshot::plastic_strain, 1e-4}};

/// The numbers that change a reading, all of them together: the derivative along a random direction of each field, to 1e-6 relative. Each
/// particle's share in it is random, so that a wrong one shows.
void check_gauge(const Gauge& gauge, std::vector<BodySnapshot> bodies, std::uint64_t seed) {
  RandomStream random(seed);
  for (BodySnapshot& body : bodies) set_pressure(body);
  const Sample reading = read(gauge, bodies);
  REQUIRE(reading.valid);
  std::vector<double> seeds;
  for (std::size_t k = 0; k < reading.values.size(); ++k) seeds.push_back(random.normal());
  static const ContactForces none;
  SnapshotGradient gradient(bodies.size());
  gauge.gradient({{1, 0.1, 0.1, 0}, bodies, none, {}}, reading, seeds.data(), gradient);
  for (const Differentiated& by : all_fields)
    for (int direction = 0; direction < 3; ++direction) {
      std::vector<BodySnapshot> ahead = bodies, behind = bodies;
      double exact = 0, size = 0;
      for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t i = 0; i < (bodies[b].*by.field).size(); ++i) {
          const double along = random.normal(), share = (gradient[b].*by.field).empty() ? 0 : (gradient[b].*by.field)[i];
          (ahead[b].*by.field)[i] += by.step * along;
          (behind[b].*by.field)[i] -= by.step * along;
          exact += share * along;
          size += share * share;
        }
      const double measured = (weighted(gauge, ahead, seeds) - weighted(gauge, behind, seeds)) / (2 * by.step);
      INFO("field " << (&by - all_fields.data()) << ", |gradient| " << std::sqrt(size));
      CHECK(measured == Approx(exact).epsilon(0).margin(1e-6 * std::sqrt(size) + (size == 0 ? 1e-12 : 0)));
    }
}

void check_everywhere(const Model& model, const Gauge& gauge) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) check_gauge(gauge, {heap(model, seed)}, seed);
}

const Model flat = empty_model(2, {24, 12, 1}, 0.05);
const Model space = empty_model(3, {12, 6, 8}, 0.1);

deck::FrontGauge front(const std::string& axis) {
  deck::FrontGauge gauge;
  gauge.body = "sand";
  gauge.axis = axis;
  return gauge;
}

}  // namespace

TEST_CASE("derivatives of region means") {
  for (const char* field : {"velocity", "pressure", "density", "stress", "plastic_strain", "position", "id"}) {
    check_everywhere(flat, *make_gauge(deck::RegionMeanGauge{field, {0.0, 0.0}, {0.3, 0.2}}, flat));
    check_everywhere(space, *make_gauge(deck::RegionMeanGauge{field, {0.1, 0.1, 0.05}, {0.5, 0.4, 0.3}}, space));
  }
}

TEST_CASE("derivatives of fronts by quantile, in both directions, as a radius and of the largest cluster") {
  for (const double quantile : {0.3, 0.9, 0.995}) {
    deck::FrontGauge gauge = front("x");
    gauge.quantile = quantile;
    check_everywhere(flat, *make_gauge(gauge, flat));
    gauge.direction = "-";
    gauge.connected = true;
    check_everywhere(flat, *make_gauge(gauge, flat));
    gauge = front("radius");
    gauge.center = {0.1, 0.05};
    gauge.quantile = quantile;
    check_everywhere(space, *make_gauge(gauge, space));
  }
}

TEST_CASE("derivatives of fronts by depth") {
  deck::FrontGauge gauge = front("x");
  gauge.depth = 0.1;
  check_everywhere(flat, *make_gauge(gauge, flat));
  check_everywhere(space, *make_gauge(gauge, space));
  gauge.smooth = 0.15;
  check_everywhere(flat, *make_gauge(gauge, flat));
  gauge = front("radius");
  gauge.center = {0, 0};
  gauge.depth = 0.08;
  check_everywhere(space, *make_gauge(gauge, space));
}

TEST_CASE("derivatives of heights, beside walls too, and of a deposit's") {
  for (const double at : {0.0, 0.01, 0.2, 0.43}) {
    check_everywhere(flat, *make_gauge(deck::HeightGauge{{at}}, flat));
    for (const auto reading : {deck::ProfileReading::surface, deck::ProfileReading::depth})
      check_everywhere(flat, *make_deposit_gauge({at}, flat, 0, reading));
    check_everywhere(space, *make_gauge(deck::HeightGauge{{at, 0.0}}, space));
  }
  // Beside an obstacle material lies lower than its top, which is the ground here.
  Model stepped = flat;
  const auto above = [](const Point& x) { return SignedDistance{x[1] - 2.3, {0, 1, 0}}; };
  stepped.obstacles.push_back({"step", deck::ContactKind::slip, 0, above, nullptr});
  for (const double at : {0.2, 0.43}) check_everywhere(stepped, *make_gauge(deck::HeightGauge{{at}}, stepped));
  // Gravity upwards: the material hangs from the top, and the surface is its lower end.
  Model hanging = flat;
  hanging.gravity = {0, 10, 0};
  hanging.domain_min = {0, -0.6, 0};
  BodySnapshot body = heap(flat, 5);
  for (std::size_t p = 0; p < body.id.size(); ++p) body.position[2 * p + 1] *= -1;
  check_gauge(*make_gauge(deck::HeightGauge{{0.1}}, hanging), {body}, 5);
}

TEST_CASE("a deposit is one body's, and the ground where that is not") {
  Model two = flat;
  two.bodies.push_back(two.bodies[0]);
  const auto layer = [&](double from, double to) {
    return fill(flat, 2, [=](const Point& x) { return x[0] < 0.6 && x[1] > from && x[1] < to; });
  };
  const std::vector<BodySnapshot> bodies{layer(0, 0.2), layer(0.2, 0.3)};
  CHECK(read(*make_gauge(deck::HeightGauge{{0.3}}, two), bodies).values[0] == Approx(0.3).margin(1e-6));
  for (const auto reading : {deck::ProfileReading::surface, deck::ProfileReading::depth})
    CHECK(read(*make_deposit_gauge({0.3}, two, 0, reading), bodies).values[0] == Approx(0.2).margin(1e-6));
  CHECK(read(*make_deposit_gauge({0.3}, two, 1, deck::ProfileReading::depth), bodies).values[0] == Approx(0.1).margin(1e-6));
  for (const auto& [at, body] : {std::pair{0.3, std::size_t(1)}, {1.0, std::size_t(0)}}) {
    const auto gauge = make_deposit_gauge({at}, two, body, deck::ProfileReading::surface);
    const Sample dry = read(*gauge, bodies);
    CHECK(dry.valid);
    CHECK(dry.values == std::vector<double>{0});
    SnapshotGradient gradient(2);
    const double seed = 1;
    gauge->gradient({{1, 0.1, 0.1, 0}, bodies, {}, {}}, dry, &seed, gradient);
    CHECK(gradient[body].position.empty());
  }
}

TEST_CASE("derivatives of pressure, momentum and chosen particles") {
  check_everywhere(flat, *make_gauge(deck::PressureGauge{{0.02, 0.1}}, flat));
  check_everywhere(space, *make_gauge(deck::PressureGauge{{0.3, 0.2, 0.1}}, space));
  check_everywhere(flat, *make_gauge(deck::MomentumGauge{}, flat));
  Model model = flat;
  for (std::uint32_t id = 0; id < 20; ++id) model.bodies[0].initial.id.push_back(id);
  check_everywhere(flat, *make_gauge(deck::ParticlesGauge{{7, 2, 11}, {"velocity", "pressure", "id", "position", "stress"}}, model));
}

TEST_CASE("gauges without a derivative say so") {
  const std::vector<BodySnapshot> bodies{heap(flat, 1)};
  const Scene scene{{1, 0.1, 0.1, 0}, bodies, {}, {}};
  const std::vector<double> seeds(7, 1.0);
  for (const auto& gauge : {make_gauge(deck::EnergyGauge{}, flat), make_gauge(deck::ForceGauge{"", "y_min"}, flat),
                            make_gauge(deck::RegionMeanGauge{"velocity_gradient", {0, 0}, {1, 1}}, flat)}) {
    SnapshotGradient gradient(1);
    CHECK_THROWS_WITH(gauge->gradient(scene, {true, seeds}, seeds.data(), gradient), Catch::Contains("no derivative"));
  }
}
