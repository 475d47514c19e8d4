// The fast step against the reference step, from the same state, for every combination of scheme, material and wall.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <map>

#include "reference/step.hpp"
#include "scenes.hpp"
#include "solvers/solver.hpp"

using namespace jaxmpm;

namespace {

/// Arrays of a checkpoint as doubles, by name.
using Arrays = std::map<std::string, std::vector<double>>;

template <class T>
std::vector<double> as_doubles(const RawArray& array) {
  std::vector<T> values(array.bytes.size() / sizeof(T));
  std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
  return {values.begin(), values.end()};
}

Arrays arrays_of(const Solver& solver) {
  Arrays all;
  for (const RawArray& a : solver.save())
    all[a.name] = a.type == "f4"
                      ? as_doubles<float>(a)
                      : (a.type == "f8" ? as_doubles<double>(a) : (a.type == "u4" ? as_doubles<std::uint32_t>(a) : as_doubles<long>(a)));
  return all;
}

/// The reference state with the particles of the fast one, in its storage order.
ReferenceState<double> state_of(const Model& model, const Arrays& arrays) {
  ReferenceState<double> state = reference_state<double>(model);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const std::string body = "body" + std::to_string(b) + "_";
    ReferenceBody<double>& r = state.bodies[b];
    r.mass = arrays.at(body + "mass"), r.compression = arrays.at(body + "compression");
    if (arrays.count(body + "dilation_0")) r.dilation = arrays.at(body + "dilation_0");
    for (std::size_t a = 0; a < r.mass.size(); ++a) {
      for (std::size_t d = 0; d < std::size_t(model.dim); ++d) {
        r.position[a][d] = arrays.at(body + "position_" + std::to_string(d))[a];
        r.velocity[a][d] = arrays.at(body + "velocity_" + std::to_string(d))[a];
        for (std::size_t k = 0; k < std::size_t(model.dim); ++k) {
          const auto affine = arrays.find(body + "affine_" + std::to_string(d * std::size_t(model.dim) + k));
          r.affine[a][d][k] = affine == arrays.end() ? 0.0 : affine->second[a];
        }
      }
      for (std::size_t k = 0; k < r.history[a].size(); ++k) r.history[a][k] = arrays.at(body + "history_" + std::to_string(k))[a];
    }
  }
  return state;
}

/// Largest difference of a field over its largest value.
struct Difference {
  double difference = 0, largest = 0;
  void add(double a, double b) {
    if (!(std::abs(a - b) <= difference)) difference = std::abs(a - b);
    largest = std::max(largest, std::abs(b));
  }
  double relative() const { return largest > 0 ? difference / largest : difference; }
};

/// Differences of every field after one more step of both.
std::map<std::string, Difference> compare(const Model& model, Solver& solver, double dt, double time) {
  ReferenceState<double> state = state_of(model, arrays_of(solver));
  const Arrays before = arrays_of(solver);
  solver.step(dt);
  reference_step(model, state, dt, time);
  const Arrays after = arrays_of(solver);
  std::map<std::string, Difference> found;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const std::string body = "body" + std::to_string(b) + "_";
    REQUIRE(before.at(body + "id") == after.at(body + "id"));  // no sort in between
    const ReferenceBody<double>& r = state.bodies[b];
    const auto fast = [&](const std::string& name, std::size_t k, std::size_t a) {
      return after.at(body + name + "_" + std::to_string(k))[a];
    };
    for (std::size_t a = 0; a < r.mass.size(); ++a) {
      found[body + "compression"].add(after.at(body + "compression")[a], r.compression[a]);
      if (after.count(body + "dilation_0")) found[body + "dilation"].add(fast("dilation", 0, a), r.dilation[a]);
      for (std::size_t d = 0; d < std::size_t(model.dim); ++d) {
        found["position"].add(fast("position", d, a), r.position[a][d]);
        found["velocity"].add(fast("velocity", d, a), r.velocity[a][d]);
        for (std::size_t k = 0; k < std::size_t(model.dim); ++k)
          if (after.count(body + "affine_0")) found["affine"].add(fast("affine", d * std::size_t(model.dim) + k, a), r.affine[a][d][k]);
      }
      for (std::size_t k = 0; k < r.history[a].size(); ++k) {
        const bool strain =
            r.history[a].size() % 2 == 1 && k + 1 == r.history[a].size() && r.history[a].size() != 9;  // stress and plastic strain
        found[body + (strain ? "plastic_strain" : "history")].add(fast("history", k, a), r.history[a][k]);
      }
    }
  }
  return found;
}

void check_step(const Model& model, Solver& solver, double dt, double time) {
  const double tolerance = model.method.precision == deck::Precision::f64 ? 1e-12 : 2e-5;
  for (const auto& [field, difference] : compare(model, solver, dt, time)) {
    INFO("field " << field << ", largest " << difference.largest);
    CHECK(difference.relative() < tolerance);
  }
}
void check_step(const Model& model, double dt) {
  const auto solver = make_solver(model, Backend::cpu);
  for (int warm_up = 0; warm_up < 3; ++warm_up) solver->step(dt);
  check_step(model, *solver, dt, 3 * dt);
}

}  // namespace

TEST_CASE("the fast step matches the reference step for every scheme") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  method.transfer = GENERATE(deck::Transfer::pic, deck::Transfer::flip, deck::Transfer::apic, deck::Transfer::tpic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  method.gradient = GENERATE(deck::GradientForm::spline, deck::GradientForm::mls);
  if (method.basis == deck::Basis::linear && method.gradient == deck::GradientForm::mls) return;
  CAPTURE(dim, int(method.precision), int(method.transfer), int(method.basis), int(method.gradient));
  check_step(busy_scene(dim, method, water(2.0), sand(), deck::ContactKind::friction), 1e-4);
}

TEST_CASE("the fast step matches the reference step when particles have moved as far as they may before they are sorted") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  CAPTURE(dim, int(method.transfer), int(method.basis));
  const Model model = busy_scene(dim, method, water(2.0), sand(), deck::ContactKind::friction);
  constexpr double dt = 1e-4;
  const auto first = make_solver(model, Backend::cpu), second = make_solver(model, Backend::cpu);
  int sorting = 0;  // the step that begins with a sort
  for (const std::uint64_t sorts = first->sorts(); first->sorts() == sorts; ++sorting) first->step(dt);
  REQUIRE(sorting > 20);
  for (int step = 0; step < sorting - 2; ++step) second->step(dt);
  check_step(model, *second, dt, (sorting - 2) * dt);
  check_step(model, *first, dt, sorting * dt);
}

TEST_CASE("the fast step matches the reference step for every material and wall") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  const auto kind = GENERATE(deck::ContactKind::slip, deck::ContactKind::no_slip, deck::ContactKind::separate, deck::ContactKind::friction);
  CAPTURE(dim, int(method.precision), int(method.transfer), int(kind));
  check_step(busy_scene(dim, method, water(), rubber(), kind), 1e-4);
  check_step(busy_scene(dim, method, sand(), elastic(), kind), 1e-4);
}

TEST_CASE("the fast step matches the reference step with body force, damping, moving walls and periodic faces") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  const auto kind = GENERATE(deck::ContactKind::slip, deck::ContactKind::no_slip, deck::ContactKind::friction);
  CAPTURE(dim, int(method.precision), int(method.transfer), int(method.basis), int(kind));
  check_step(driven(busy_scene(dim, method, water(2.0), sand(), kind)), 1e-4);
  check_step(periodic_scene(dim, method, water(2.0), sand(), kind), 1e-4);
}

TEST_CASE("forces on a wall are the momentum that it gives") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  const auto kind = GENERATE(deck::ContactKind::slip, deck::ContactKind::no_slip, deck::ContactKind::separate, deck::ContactKind::friction);
  CAPTURE(dim, int(method.transfer), int(method.basis), int(kind));
  Model model = driven(busy_scene(dim, method, water(2.0), sand(), kind));
  const bool corner = GENERATE(false, true), mixed = GENERATE(false, true);  // against all faces around; with a no_slip wall among them
  CAPTURE(corner, mixed);
  model.obstacles.clear(), model.bodies.resize(1);
  model.cells = {16, 16, dim == 3 ? 12 : 1};
  if (mixed) model.faces[0].kind = deck::ContactKind::no_slip, model.faces[0].coefficient = {}, model.faces[0].to = {};
  const double near = corner ? 0 : 4;
  model.bodies[0] = jittered_body("pool", water(2.0), dim, {near, 0, near}, {11, 5, 8}, model.cell_size, 0, 0.8, 0);
  const auto solver = make_solver(model, Backend::cpu);
  solver->record_forces(true);
  const double dt = 1e-4;
  for (int k = 0; k < 3; ++k) solver->step(dt);
  ReferenceState<double> state = state_of(model, arrays_of(*solver));
  solver->step(dt);
  const auto report = reference_step(model, state, dt, 3 * dt);
  const auto& force = solver->forces().face;
  double size = 0;
  for (const double component : force[2]) size = std::max(size, std::abs(component));
  REQUIRE(size > 0);
  for (std::size_t f = 0; f < 2 * std::size_t(dim); ++f)
    for (int c = 0; c < dim; ++c)
      CHECK(force[f][std::size_t(c)] == Approx(report.face_impulse[f][c] * (1 / dt + model.method.damping)).margin(1e-11 * size));
}

TEST_CASE("the fast step averages changes of volume as the reference step does") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.volume_averaging = GENERATE(0.4, 1.0);
  method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  method.transfer = GENERATE(deck::Transfer::pic, deck::Transfer::flip, deck::Transfer::apic, deck::Transfer::tpic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  method.gradient = GENERATE(deck::GradientForm::spline, deck::GradientForm::mls);
  if (method.basis == deck::Basis::linear && method.gradient == deck::GradientForm::mls) return;
  CAPTURE(dim, method.volume_averaging, int(method.precision), int(method.transfer), int(method.basis), int(method.gradient));
  check_step(busy_scene(dim, method, water(2.0), sand(), deck::ContactKind::friction), 1e-4);
  check_step(driven(busy_scene(dim, method, elastic(), rubber(), deck::ContactKind::no_slip)), 1e-4);
}

TEST_CASE("a slope that meets a face of the domain does not push material out of it") {
  for (const auto kind : {deck::ContactKind::slip, deck::ContactKind::separate, deck::ContactKind::friction}) {
    deck::Method method;
    method.precision = deck::Precision::f32;
    Model model = busy_scene(2, method, sand(), sand(), deck::ContactKind::slip);
    model.bodies.resize(1);
    model.gravity = {0, -90, 0};
    model.bodies[0] = jittered_body("stream", sand(), 2, {21.5, 8, 0}, {24, 9, 0}, model.cell_size, 0, 0, 0);
    BodyState& stream = model.bodies[0].initial;
    for (std::size_t p = 0; p < stream.id.size(); ++p) {
      stream.velocity[p] = {0.5, -2, 0};
      if (p % 5 == 0) stream.position[p][0] = model.cells[0] - 1e-6;  // some of it touches the face already
    }
    const Point through{18, 9, 0}, normal{0.28, 0.96, 0};  // falls towards x_max
    model.obstacles[0].kind = kind;
    model.obstacles[0].signed_distance = [=](const Point& x) {
      return SignedDistance{normal[0] * (x[0] - through[0]) + normal[1] * (x[1] - through[1]), normal};
    };
    const auto solver = make_solver(model, Backend::cpu);
    CHECK_NOTHROW([&] {
      for (int k = 0; k < 500; ++k) solver->step(1e-4);
    }());
  }
}

TEST_CASE("a closed face holds what its nodes would let pass, in the fast step as in the reference step") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  CAPTURE(dim, int(method.precision), int(method.transfer));
  const Model model = creeping_scene(dim, method);
  const auto solver = make_solver(model, Backend::cpu);
  check_step(model, *solver, 2e-4, 0);
  const Arrays after = arrays_of(*solver);
  for (const char* body : {"body0", "body1"}) {
    const std::vector<double>& X = after.at(body + ("_position_" + std::to_string(dim - 1)));
    CHECK(std::count(X.begin(), X.end(), 0.0) >= 5);
    CHECK(*std::min_element(X.begin(), X.end()) == 0.0);
  }
}
