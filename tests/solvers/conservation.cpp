// What every scheme must keep: mass and momentum away from walls, for APIC the angular momentum, linear fields, uniform stress; and the
// same bits after a restart.
#include <catch2/catch.hpp>
#include <cstring>
#include <iostream>

#include "scenes.hpp"
#include "solvers/solver.hpp"

using namespace jaxmpm;

namespace {

Model free_flight(int dim, const deck::Method& method, const deck::Material& material) {
  Model model;
  model.dim = dim, model.method = method;
  model.cells = {30, 30, dim == 3 ? 30 : 1};
  model.cell_size = 0.02;
  const Point lower{8, 8, dim == 3 ? 8. : 0}, upper{17, 18, dim == 3 ? 17. : 1};
  model.bodies.push_back(jittered_body("flying", material, dim, lower, upper, model.cell_size, 0, 0.5, 0));
  return model;
}

struct Momenta {
  double mass = 0, scale = 0;
  Point linear{};
  double angular = 0;  // about the z axis through the origin, affine part included
};

std::vector<double> numbers(const Solver& solver, const std::string& name) {
  for (const RawArray& a : solver.save())
    if (a.name == name) {
      std::vector<double> v(a.bytes.size() / 8);
      std::memcpy(v.data(), a.bytes.data(), a.bytes.size());
      return v;
    }
  return {};
}

/// Double precision only. D: second moment of the basis in cells².
Momenta momenta(const Solver& solver, int dim, double h, double D) {
  Momenta sum;
  const BodySnapshot s = solver.snapshot({true}, false)[0];
  const auto c01 = numbers(solver, "body0_affine_1"), c10 = numbers(solver, "body0_affine_" + std::to_string(dim));
  for (std::size_t a = 0; a < s.id.size(); ++a) {
    const double* x = &s.position[a * std::size_t(dim)];
    const double* v = &s.velocity[a * std::size_t(dim)];
    sum.mass += s.mass[a];
    for (std::size_t d = 0; d < std::size_t(dim); ++d) sum.linear[d] += s.mass[a] * v[d], sum.scale += s.mass[a] * std::abs(v[d]);
    sum.angular += s.mass[a] * (x[0] * v[1] - x[1] * v[0]);
    if (!c01.empty()) sum.angular += s.mass[a] * D * h * h * (c10[a] - c01[a]);
  }
  return sum;
}

}  // namespace

TEST_CASE("mass and linear momentum are kept by every scheme") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.transfer = GENERATE(deck::Transfer::pic, deck::Transfer::flip, deck::Transfer::apic, deck::Transfer::tpic);
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  const auto solver = make_solver(free_flight(dim, method, sand()), Backend::cpu);
  const Momenta before = momenta(*solver, dim, 0.02, 0);
  for (int n = 0; n < 50; ++n) solver->step(1e-4);
  const Momenta after = momenta(*solver, dim, 0.02, 0);
  CHECK(after.mass == Approx(before.mass).epsilon(1e-14));
  for (std::size_t d = 0; d < std::size_t(dim); ++d) CHECK(std::abs(after.linear[d] - before.linear[d]) < 1e-13 * before.scale);
}

TEST_CASE("APIC keeps angular momentum with its affine part and the drift of the others is printed") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.basis = GENERATE(deck::Basis::quadratic, deck::Basis::cubic);
  method.transfer = GENERATE(deck::Transfer::apic, deck::Transfer::tpic, deck::Transfer::flip, deck::Transfer::pic);
  const double D = method.basis == deck::Basis::quadratic ? 0.25 : 1.0 / 3;
  const auto drift = [&](double dt) {
    const auto solver = make_solver(free_flight(dim, method, water()), Backend::cpu);
    solver->step(dt);  // the affine matrix has its first value after a step
    const double before = momenta(*solver, dim, 0.02, method.transfer == deck::Transfer::apic ? D : 0).angular;
    solver->step(dt);
    return std::abs(momenta(*solver, dim, 0.02, method.transfer == deck::Transfer::apic ? D : 0).angular - before) / std::abs(before);
  };
  const double full = drift(1e-4), half = drift(5e-5);
  if (method.transfer == deck::Transfer::apic) CHECK(full < 1e-12);
  else
    std::cout << "angular momentum drift a step, " << dim << "D, transfer " << int(method.transfer) << ", basis " << int(method.basis)
              << ": " << full << " at dt, " << half << " at dt/2\n";
}

TEST_CASE("a scene with periodic faces runs the same wherever it begins") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  Model here = free_flight(dim, method, water(1.0));
  const int N = dim == 2 ? 16 : 12;
  here.cells[0] = N, here.bodies[0] = jittered_body("flying", water(1.0), dim, {1, 9, 9}, {8, 14, 13}, here.cell_size, 0, 0.5, 0);
  here.faces[0].kind = here.faces[1].kind = deck::ContactKind::periodic;
  for (Point& v : here.bodies[0].initial.velocity) v[0] += 20;
  Model there = here;
  for (Point& X : there.bodies[0].initial.position) X[0] += 5;
  const auto one = make_solver(here, Backend::cpu), other = make_solver(there, Backend::cpu);
  for (int n = 0; n < 400; ++n) one->step(1e-4), other->step(1e-4);  // 40 cells: through the faces several times
  const BodySnapshot a = one->snapshot({true}, true)[0], b = other->snapshot({true}, true)[0];
  const double width = N * here.cell_size;
  double worst = 0;
  for (std::size_t p = 0; p < a.id.size(); ++p) {
    const double x = a.position[p * std::size_t(dim)], apart = b.position[p * std::size_t(dim)] - x - 5 * here.cell_size;
    worst = std::max(worst, std::abs(apart - width * std::round(apart / width)));
    CHECK((x >= 0 && x <= width));
  }
  // The last bit of a position differs by the shift; particles that collide let that grow a millionfold in 400 steps.
  CHECK(worst < 1e-8 * width);
}

TEST_CASE("a linear velocity field comes back exactly with APIC and TPIC") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.transfer = GENERATE(deck::Transfer::apic, deck::Transfer::tpic);
  method.basis = GENERATE(deck::Basis::quadratic, deck::Basis::cubic);
  Model model = free_flight(dim, method, water());
  const auto field = [](const Point& X, std::size_t d) {
    return 0.3 * double(d + 1) + 0.05 * X[0] - 0.02 * double(d) * X[1] + 0.01 * X[2];
  };
  for (std::size_t a = 0; a < model.bodies[0].initial.id.size(); ++a)
    for (std::size_t d = 0; d < std::size_t(dim); ++d)
      model.bodies[0].initial.velocity[a][d] = field(model.bodies[0].initial.position[a], d);
  const auto solver = make_solver(model, Backend::cpu);
  // Give every particle the field's gradient as its affine matrix, then take a step too short for forces to matter.
  auto arrays = solver->save();
  for (RawArray& array : arrays)
    for (std::size_t d = 0; d < std::size_t(dim); ++d)
      for (std::size_t k = 0; k < std::size_t(dim); ++k) {
        if (array.name != "body0_affine_" + std::to_string(d * std::size_t(dim) + k)) continue;
        const double slope = (k == 0 ? 0.05 : (k == 1 ? -0.02 * double(d) : 0.01)) / model.cell_size;
        for (std::size_t a = 0; a < array.bytes.size() / 8; ++a) std::memcpy(array.bytes.data() + 8 * a, &slope, 8);
      }
  solver->restore(arrays);
  const BodySnapshot before = solver->snapshot({true}, true)[0];
  solver->step(1e-14);
  const BodySnapshot after = solver->snapshot({true}, true)[0];
  for (std::size_t i = 0; i < before.velocity.size(); ++i) REQUIRE(after.velocity[i] == Approx(before.velocity[i]).margin(1e-9));
}

TEST_CASE("a restored run goes on with the same bits") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.precision = GENERATE(deck::Precision::f32, deck::Precision::f64);
  method.transfer = GENERATE(deck::Transfer::flip, deck::Transfer::apic);
  const Model model = busy_scene(dim, method, water(1.0), sand(), deck::ContactKind::friction);
  const auto whole = make_solver(model, Backend::cpu), resumed = make_solver(model, Backend::cpu);
  for (int n = 0; n < 130; ++n) whole->step(1e-4);
  resumed->restore(whole->save());
  for (int n = 0; n < 150; ++n) whole->step(1e-4), resumed->step(1e-4);
  const auto a = whole->save(), b = resumed->save();
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    INFO(a[k].name);
    CHECK(a[k].bytes == b[k].bytes);
  }
  CHECK(whole->stable_step() == resumed->stable_step());
}

TEST_CASE("uniform stress gives no interior force on a regular lattice") {
  const int dim = GENERATE(2, 3);
  deck::Method method;
  method.transfer = deck::Transfer::flip, method.flip_fraction = 1;
  method.basis = GENERATE(deck::Basis::quadratic, deck::Basis::cubic);
  const bool jittered = GENERATE(false, true);
  Model model = free_flight(dim, method, sand());
  BodyState& state = model.bodies[0].initial;
  for (std::size_t a = 0; a < state.id.size(); ++a) {
    state.velocity[a] = {}, state.compression[a] = 0, state.mass[a] = 2000 * std::pow(0.01, dim);
    state.stress[a] = {-100, -100, -100, 0, 0, 0};
    if (!jittered)
      for (std::size_t d = 0; d < std::size_t(dim); ++d) state.position[a][d] = std::floor(state.position[a][d] * 2) / 2 + 0.25;
  }
  const auto solver = make_solver(model, Backend::cpu);
  const double dt = 1e-6;
  solver->step(dt);
  const BodySnapshot s = solver->snapshot({true}, true)[0];
  double largest = 0;
  for (std::size_t a = 0; a < s.id.size(); ++a) {
    bool interior = true;
    for (std::size_t d = 0; d < std::size_t(dim); ++d) {
      const double X = s.position[a * std::size_t(dim) + d] / 0.02;
      interior = interior && X > 12 && X < 13;  // four cells from the edge: no stencil of its nodes reaches out
    }
    for (std::size_t d = 0; interior && d < std::size_t(dim); ++d)
      largest = std::max(largest, std::abs(s.velocity[a * std::size_t(dim) + d]));
  }
  const double acceleration = largest / dt * 0.02 * 2000 / 100;  // over σ/(ρ Δh)
  if (jittered) {
    std::cout << "interior force on a jittered lattice, " << dim << "D: " << acceleration << " σ/Δh\n";
    CHECK(acceleration < 3);
  } else {
    CHECK(acceleration < 1e-9);
  }
}
