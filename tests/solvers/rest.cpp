// Material at rest: it is left out exactly, stays a support, wakes when something comes, and nobody else can tell.
#include <catch2/catch.hpp>

#include "core/error.hpp"
#include "scenes.hpp"
#include "solvers/reversible.hpp"

using namespace jaxmpm;

namespace {

constexpr double h = 0.02, step = 4e-4;

/// A body on a regular lattice, 2 particles per cell and axis, at rest and free of stress, in the box of cells [lower, upper).
Body lattice_body(const std::string& name, const deck::Material& material, int dim, const Point& lower, const Point& upper,
                  std::uint32_t first_id) {
  Body body = jittered_body(name, material, dim, lower, upper, h, first_id, 0, 0);
  const double density = std::visit([](const auto& m) { return m.density; }, material);
  BodyState& state = body.initial;
  for (std::size_t a = 0; a < state.id.size(); ++a) {
    for (std::size_t d = 0; d < std::size_t(dim); ++d) state.position[a][d] = std::floor(state.position[a][d] * 2) / 2 + 0.25;
    state.mass[a] = density * std::pow(h / 2, dim), state.compression[a] = 0, state.stress[a] = {};
  }
  return body;
}

/// A bed that nothing pulls at, and a block that flies towards it.
Model bed_and_block(int dim, deck::Transfer transfer, bool rest) {
  Model model;
  model.dim = dim, model.method.transfer = transfer;
  if (rest) model.method.rest = deck::Rest{0.01, 20 * step};
  model.cells = dim == 2 ? std::array<int, 3>{48, 48, 1} : std::array<int, 3>{20, 28, 4};
  model.cell_size = h, model.time.cfl = 0.4;
  const double across = model.cells[0], bed = dim == 2 ? 24 : 12, deep = dim == 2 ? 1 : 4;
  model.bodies.push_back(lattice_body("bed", elastic(), dim, {0, 0, 0}, {across, bed, deep}, 0));
  model.bodies.push_back(lattice_body("block", elastic(), dim, {2, bed + 10, 0}, {8, bed + 14, deep}, 100000));
  for (Point& v : model.bodies[1].initial.velocity) v = {0, -2, 0};
  return model;
}

double fastest(const BodySnapshot& body) {
  double v = 0;
  for (const double component : body.velocity) v = std::max(v, std::abs(component));
  return v;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) difference = std::max(difference, std::abs(a[k] - b[k]));
  return difference;
}

}  // namespace

TEST_CASE("a bed at rest sleeps, and what hits it wakes it") {
  const int dim = GENERATE(2, 3);
  const deck::Transfer transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  const auto plain = make_solver(bed_and_block(dim, transfer, false), Backend::cpu);
  const auto resting = make_solver(bed_and_block(dim, transfer, true), Backend::cpu);
  const std::uint64_t bed = plain->snapshot({}, true)[0].id.size();
  const auto advance = [&](int steps) {
    for (int n = 0; n < steps; ++n) plain->step(step), resting->step(step);
  };
  CHECK(resting->particles_at_rest() == 0);
  advance(30);
  CHECK(resting->particles_at_rest() == bed);
  CHECK(resting->stable_step() == plain->stable_step());
  CHECK(resting->snapshot({true}, true)[1].position == plain->snapshot({true}, true)[1].position);
  advance(300);  // the block has covered 12 cells: it is in the bed, or has bounced
  const auto a = plain->snapshot({true}, true), b = resting->snapshot({true}, true);
  CHECK(resting->particles_at_rest() < bed);
  CHECK(fastest(b[0]) > 0.02);
  CHECK(fastest(b[0]) == Approx(fastest(a[0])).epsilon(0.05));
  for (std::size_t body = 0; body < 2; ++body) CHECK(largest_difference(a[body].position, b[body].position) < 0.02 * h);
}

TEST_CASE("the floor carries material at rest, which stays where it is") {
  Model model;
  model.dim = 2, model.cells = {40, 40, 1}, model.cell_size = h, model.gravity = {0, -10, 0};
  model.method.rest = deck::Rest{0.01, 50 * step};
  model.bodies.push_back(lattice_body("bed", elastic(), 2, {0, 0, 0}, {40, 24, 1}, 0));
  BodyState& state = model.bodies[0].initial;
  double weight = 0;
  for (std::size_t a = 0; a < state.id.size(); ++a) {
    const double vertical = -1500 * 10 * h * (24 - state.position[a][1]);
    state.stress[a] = {3. / 7 * vertical, vertical, 3. / 7 * vertical, 0, 0, 0}, weight += 10 * state.mass[a];  // ν/(1 − ν) = 3/7
  }
  const auto solver = make_solver(model, Backend::cpu);
  solver->record_forces(true);
  for (int n = 0; n < 100; ++n) solver->step(step);
  REQUIRE(solver->particles_at_rest() == state.id.size());
  const auto before = solver->snapshot({true}, true)[0];
  CHECK(fastest(before) == 0);
  for (int n = 0; n < 20; ++n) {
    solver->step(step * (1 + 0.05 * n));
    CHECK(solver->forces().face[2][1] == Approx(weight).epsilon(0.01));
  }
  CHECK(solver->snapshot({}, true)[0].position == before.position);
}

TEST_CASE("with blocks at rest a restored run goes on with the same bits, and recorded forces change nothing") {
  const int dim = GENERATE(2, 3);
  const deck::Transfer transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  Model model = bed_and_block(dim, transfer, true);
  if (GENERATE(false, true)) model.method.precision = deck::Precision::f32;
  const auto whole = make_solver(model, Backend::cpu), resumed = make_solver(model, Backend::cpu),
             watched = make_solver(model, Backend::cpu);
  watched->record_forces(true);
  std::uint64_t most = 0;
  for (int n = 0; n < 255; ++n) {  // into the impact, with steps of changing length
    if (n == 25 || n == 240) resumed->restore(whole->save());
    const double dt = step * (1 + 0.1 * (n % 3));
    whole->step(dt), watched->step(dt);
    if (n >= 25) resumed->step(dt);
    most = std::max(most, whole->particles_at_rest());
  }
  CHECK(most > 0);
  CHECK(whole->particles_at_rest() < most);  // the impact has woken some
  const auto a = whole->save(), b = resumed->save(), c = watched->save();
  REQUIRE((a.size() == b.size() && a.size() == c.size()));
  for (std::size_t k = 0; k < a.size(); ++k) {
    INFO(a[k].name);
    CHECK(a[k].bytes == b[k].bytes);
    CHECK(a[k].bytes == c[k].bytes);
  }
  CHECK(whole->stable_step() == resumed->stable_step());
}

TEST_CASE("a checkpoint without the times of rest is refused") {
  const auto solver = make_solver(bed_and_block(2, deck::Transfer::apic, true), Backend::cpu);
  auto arrays = solver->save();
  arrays.erase(std::find_if(arrays.begin(), arrays.end(), [](const RawArray& array) { return array.name == "rest"; }));
  CHECK_THROWS_AS(solver->restore(arrays), IoError);
}

TEST_CASE("gradients and GPUs refuse material at rest") {
  const Model model = bed_and_block(2, deck::Transfer::apic, true);
  CHECK_THROWS_AS(make_reversible_solver(model, Backend::cpu), DeckError);
  CHECK_THROWS_AS(make_solver(model, Backend::cuda), DeckError);
}
