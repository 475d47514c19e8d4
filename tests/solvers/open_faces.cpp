// Open faces: the grid there against the reference step, and particles that leave.
#include <catch2/catch.hpp>

#include "core/error.hpp"
#include "reference/step.hpp"
#include "scenes.hpp"
#include "solvers/reversible.hpp"
#include "solvers/solver.hpp"

using namespace jaxmpm;

namespace {

constexpr double dt = 2e-4;
const FieldSelection fields{true, true, true, true, false, true, false};

/// The busy scene, on its way out through the upper faces of x and, in 3D, y.
Model leaving_scene(int dim, deck::Transfer transfer, deck::Basis basis, deck::ContactKind kind) {
  deck::Method method;
  method.transfer = transfer, method.basis = basis, method.precision = deck::Precision::f64;
  Model model = busy_scene(dim, method, water(1), sand(), kind);
  for (const std::size_t f : {1, 3})
    if (f == 1 || dim == 3) model.faces[f] = {deck::ContactKind::open, {}, {}, 0, {}};
  for (Body& body : model.bodies)
    for (Point& v : body.initial.velocity) v[0] += 6, v[1] += dim == 3 ? 3 : 0;
  return model;
}

double total_mass(const Solver& solver) {
  double sum = 0;
  for (const BodySnapshot& body : solver.snapshot(fields, true))
    for (const double m : body.mass) sum += m;
  return sum;
}

/// Both steps, side by side: the same particles are there, with the same fields.
void compare(const Model& model, int steps) {
  const std::unique_ptr<Solver> solver = make_solver(model, Backend::cpu);
  ReferenceState<double> state = reference_state<double>(model);
  const std::uint64_t first = solver->particle_count();
  for (int k = 0; k < steps; ++k) solver->step(dt), reference_step(model, state, dt, k * dt);
  CHECK(solver->particle_count() < first);
  const std::vector<BodySnapshot> shown = solver->snapshot(fields, true);
  std::uint64_t there = 0;
  double worst = 0;
  for (std::size_t b = 0; b < shown.size(); ++b) {
    std::size_t next = 0;
    for (std::size_t p = 0; p < state.bodies[b].mass.size(); ++p) {
      if (!(state.bodies[b].mass[p] > 0)) continue;
      REQUIRE(next < shown[b].id.size());
      REQUIRE(shown[b].id[next] == model.bodies[b].initial.id[p]);
      for (std::size_t d = 0; d < std::size_t(model.dim); ++d) {
        const std::size_t i = next * std::size_t(model.dim) + d;
        worst = std::max(worst, std::abs(shown[b].velocity[i] - state.bodies[b].velocity[p][d]));
        worst = std::max(worst, std::abs((shown[b].position[i] - model.domain_min[d]) / model.cell_size - state.bodies[b].position[p][d]));
      }
      ++next, ++there;
    }
    CHECK(next == shown[b].id.size());
  }
  CHECK(there == solver->particle_count());
  INFO("largest difference " << worst);
  CHECK(worst < 1e-7);
}

}  // namespace

using deck::Basis;
using deck::ContactKind;
using deck::Transfer;

TEST_CASE("the fast step agrees with the reference where particles leave") {
  SECTION("2D, APIC, quadratic, slip") { compare(leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::slip), 60); }
  SECTION("2D, FLIP, cubic, friction") { compare(leaving_scene(2, Transfer::flip, Basis::cubic, ContactKind::friction), 60); }
  SECTION("2D, TPIC, linear, no_slip") {
    Model model = leaving_scene(2, Transfer::tpic, Basis::linear, ContactKind::no_slip);
    model.obstacles.clear();  // it would hold them
    compare(model, 60);
  }
  SECTION("3D, APIC, quadratic, separate") { compare(leaving_scene(3, Transfer::apic, Basis::quadratic, ContactKind::separate), 15); }
  SECTION("a belt carries them out") {
    Model model = leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::no_slip);
    model.faces[2].velocity = {3, 0, 0};
    model.obstacles.clear();
    compare(model, 60);
  }
}

TEST_CASE("a run goes on to the same bits from a state that has lost particles") {
  const Model model = leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::slip);
  const std::unique_ptr<Solver> one = make_solver(model, Backend::cpu), other = make_solver(model, Backend::cpu);
  for (int k = 0; k < 50; ++k) one->step(dt);
  other->restore(one->save());
  CHECK(other->particle_count() == one->particle_count());
  for (int k = 0; k < 50; ++k) one->step(dt), other->step(dt);
  for (std::size_t b = 0; b < 2; ++b) {
    const BodySnapshot x = one->snapshot(fields, true)[b], y = other->snapshot(fields, true)[b];
    CHECK(x.id == y.id);
    CHECK(x.position == y.position);
    CHECK(x.velocity == y.velocity);
  }
  const std::unique_ptr<Solver> whole = make_solver(model, Backend::cpu);  // back to when more were there
  const auto first = whole->save();
  for (int k = 0; k < 50; ++k) whole->step(dt);
  whole->restore(first);
  CHECK(total_mass(*whole) == total_mass(*make_solver(model, Backend::cpu)));
}

TEST_CASE("a run goes on when all its particles have left") {
  Model model = leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::slip);
  model.obstacles.clear(), model.gravity = {};
  for (std::size_t f = 0; f < 4; ++f) model.faces[f] = {ContactKind::open, {}, {}, 0, {}};
  const std::unique_ptr<Solver> solver = make_solver(model, Backend::cpu);
  double mass = total_mass(*solver);
  for (int k = 0; k < 1500; ++k) {
    solver->step(dt);
    const double left = k % 50 == 0 ? total_mass(*solver) : mass;
    CHECK(left <= mass);
    mass = left;
  }
  CHECK(solver->particle_count() == 0);
  CHECK(solver->stable_step() > 0);
  CHECK(solver->stable_step() < 1);
  CHECK(solver->snapshot(fields, true)[0].id.empty());
  solver->restore(solver->save());
  solver->step(dt);
}

TEST_CASE("open faces are refused where particles have to stay") {
  const Model model = leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::slip);
  CHECK_THROWS_AS(make_reversible_solver(model, Backend::cpu), DeckError);
}

TEST_CASE("a particle that leaves through a wall beside an open face is a failure still") {
  const Model model = leaving_scene(2, Transfer::apic, Basis::quadratic, ContactKind::slip);
  const std::unique_ptr<Solver> solver = make_solver(model, Backend::cpu);
  CHECK_THROWS_WITH(solver->step(0.5), Catch::Contains("has left the domain"));
}
