// What the step must conserve, and what it must reproduce exactly.
#include "scenes.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm::test {
namespace {

/// Two bodies of different materials, colliding in the open; no wall, no gravity.
Model collision(int dim) {
  Model model = empty_model(dim, {14, 13, 12});
  const Point a{3, 3, 3}, b{6, 5, 5}, c{5, 5, 5}, d{8, 8, 7};
  model.bodies = {block(model, "water", fluid(20, 3), a, b, 2), block(model, "jelly", jelly(), c, d, 2)};
  disturb(model, model.bodies[0], 2, 1);
  disturb(model, model.bodies[1], 2, 2);
  return model;
}

/// Σ m x × v and the part that the affine matrices carry, Σ m D (C − Cᵀ), about the domain's corner.
Triple<double> angular_momentum(const Model& model, const ReferenceState<double>& state, bool affine) {
  Triple<double> sum{};
  const double D = model.cell_size * model.cell_size / (model.method.basis == deck::Basis::quadratic ? 4 : 3);
  for (const auto& body : state.bodies)
    for (std::size_t p = 0; p < body.mass.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        const auto& x = body.position[p];
        const auto& v = body.velocity[p];
        sum[c] += body.mass[p] * model.cell_size * (x[a] * v[b] - x[b] * v[a]);
        if (affine) sum[c] += body.mass[p] * D * (body.affine[p][b][a] - body.affine[p][a][b]);
      }
  return sum;
}

double largest(const Triple<double>& a, const Triple<double>& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Σ m |v|, the scale for momenta.
double momentum_scale(const ReferenceState<double>& state) {
  double sum = 0;
  for (const auto& body : state.bodies)
    for (std::size_t p = 0; p < body.mass.size(); ++p) sum += body.mass[p] * std::abs(body.velocity[p][0]);
  return sum;
}

TEST_CASE("reference: mass and momentum are conserved by every scheme") {
  double worst = 0;
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme()) {
      Model model = collision(dim);
      use(model, scheme);
      ReferenceState<double> state = reference_state<double>(model);
      disturb_affine(model, state, 10, 3);
      const double mass = total_mass(state), scale = momentum_scale(state);
      for (int step = 0; step < 3; ++step) {
        const Triple<double> before = total_momentum(state);
        const auto report = reference_step<double>(model, state, 2e-4);
        double grid_mass = 0;
        for (const auto& [node, values] : report.grid) grid_mass += values.mass;
        worst = std::max({worst, std::abs(grid_mass / mass - 1), largest(before, total_momentum(state)) / scale});
      }
      INFO(name_of(scheme) << " in " << dim << "D");
      CHECK(worst < 1e-13);
    }
  WARN("largest relative change of mass or momentum in a step: " << worst);
}

TEST_CASE("reference: APIC conserves angular momentum with its affine part") {
  double worst = 0;
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme()) {
      if (scheme.transfer != deck::Transfer::apic || scheme.basis == deck::Basis::linear) continue;
      Model model = collision(dim);
      use(model, scheme);
      ReferenceState<double> state = reference_state<double>(model);
      disturb_affine(model, state, 10, 4);
      const double scale = momentum_scale(state);
      for (int step = 0; step < 5; ++step) {
        const Triple<double> before = angular_momentum(model, state, true);
        reference_step<double>(model, state, 2e-4);
        worst = std::max(worst, largest(before, angular_momentum(model, state, true)) / scale);
      }
    }
  WARN("largest relative change of angular momentum in an APIC step: " << worst);
  CHECK(worst < 1e-12);
}

/// Relative change of the angular momentum of a turning block of jelly in 0.004 s.
double drift(const Scheme& scheme, double cell_size, double dt) {
  Model model = empty_model(2, {int(std::lround(1.6 / cell_size)), int(std::lround(1.6 / cell_size)), 1}, cell_size);
  use(model, scheme);
  const double cells = 1 / cell_size;
  model.bodies = {block(model, "block", jelly(), {0.5 * cells, 0.6 * cells, 0}, {1.1 * cells, 1.0 * cells, 0}, 2)};
  for (std::size_t p = 0; p < model.bodies[0].initial.mass.size(); ++p) {
    const Point& x = model.bodies[0].initial.position[p];
    model.bodies[0].initial.velocity[p] = {-3 * (x[1] * cell_size - 0.8), 3 * (x[0] * cell_size - 0.8), 0};
  }
  ReferenceState<double> state = reference_state<double>(model);
  const bool affine = scheme.transfer == deck::Transfer::apic && scheme.basis != deck::Basis::linear;
  const double before = angular_momentum(model, state, affine)[2];
  for (int step = 0; step < std::lround(0.004 / dt); ++step) reference_step<double>(model, state, dt);
  return std::abs(angular_momentum(model, state, affine)[2] / before - 1);
}

TEST_CASE("reference: drift of angular momentum of the other schemes, with its order") {
  using namespace deck;
  for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::tpic}) {
    const Scheme scheme{transfer, Basis::quadratic, GradientForm::spline};
    const double coarse = drift(scheme, 0.1, 1e-3), finer_grid = drift(scheme, 0.05, 1e-3), finer_step = drift(scheme, 0.1, 5e-4);
    WARN(name_of(scheme) << ": drift over 0.004 s " << coarse << ", half the cell size " << finer_grid << " (order "
                         << std::log2(coarse / finer_grid) << "), half the step " << finer_step << " (order "
                         << std::log2(coarse / finer_step) << ")");
    CHECK(coarse < 0.5);
    CHECK(finer_grid < coarse);
  }
}

TEST_CASE("reference: a linear velocity field comes back exactly with APIC and TPIC") {
  double worst = 0;
  const double A[3][3] = {{0.3, -1.2, 0.5}, {0.9, 0.4, -0.7}, {-0.2, 1.1, -0.6}};
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme()) {
      if (scheme.transfer != deck::Transfer::apic && scheme.transfer != deck::Transfer::tpic) continue;
      Model model = empty_model(dim, {9, 9, 9}, 0.25);
      use(model, scheme);
      model.bodies = {block(model, "cloud", fluid(), {3, 3, 3}, {5, 6, 5}, 2)};
      disturb(model, model.bodies[0], 0, 5);
      for (double& e : model.bodies[0].initial.compression) e = 0;
      const auto field = [&](const Triple<double>& X, int c) {
        double v = 0.1 * (c + 1);
        for (int a = 0; a < dim; ++a) v += A[c][a] * X[a] * model.cell_size;
        return v;
      };
      ReferenceState<double> state = reference_state<double>(model);
      ReferenceBody<double>& body = state.bodies[0];
      for (std::size_t p = 0; p < body.mass.size(); ++p)
        for (int c = 0; c < dim; ++c) {
          body.velocity[p][c] = field(body.position[p], c);
          for (int a = 0; a < dim; ++a) body.affine[p][c][a] = A[c][a];
        }
      const ReferenceBody<double> before = body;
      reference_step<double>(model, state, 1e-3);
      for (std::size_t p = 0; p < body.mass.size(); ++p)
        for (int c = 0; c < dim; ++c) {
          worst = std::max(worst, std::abs(body.velocity[p][c] - field(before.position[p], c)));
          for (int a = 0; a < dim; ++a)
            worst = std::max({worst, std::abs(body.affine[p][c][a] - A[c][a]), std::abs(body.velocity_gradient[p][c][a] - A[c][a])});
        }
      INFO(name_of(scheme) << " in " << dim << "D");
      CHECK(worst < 1e-12);
    }
  WARN("largest error of velocity, affine matrix and gradient: " << worst);
}

/// Largest internal force on a node two cells inside a block under uniform pressure, relative to the largest one on its edge.
double inner_force(int dim, const Scheme& scheme, bool jitter) {
  Model model = empty_model(dim, {12, 12, 12});
  use(model, scheme);
  model.bodies = {block(model, "block", fluid(), {2, 2, 2}, {10, 10, 10}, 2)};
  if (jitter) disturb(model, model.bodies[0], 0, 6);
  for (double& e : model.bodies[0].initial.compression) e = 1e-3;
  for (double& m : model.bodies[0].initial.mass) m = 1.001 * 1000 * std::pow(model.cell_size / 2, dim);
  ReferenceState<double> state = reference_state<double>(model);
  const auto report = reference_step<double>(model, state, 1e-9);
  double inside = 0, edge = 0;
  for (const auto& [node, values] : report.grid) {
    bool interior = true;
    for (int a = 0; a < dim; ++a) interior = interior && node[a] >= 4 && node[a] <= 8;
    for (const double f : values.force) (interior ? inside : edge) = std::max(interior ? inside : edge, std::abs(f));
  }
  return inside / edge;
}

TEST_CASE("reference: uniform stress gives no interior force on a regular lattice, a bounded one on a jittered one") {
  double regular = 0, jittered = 0;
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme()) {
      if (scheme.transfer != deck::Transfer::apic) continue;
      regular = std::max(regular, inner_force(dim, scheme, false));
      jittered = std::max(jittered, inner_force(dim, scheme, true));
    }
  WARN("interior force relative to the edge: " << regular << " on a lattice, " << jittered << " jittered by a fifth of a cell");
  CHECK(regular < 1e-12);
  CHECK(jittered < 1);
}

}  // namespace
}  // namespace jaxmpm::test
