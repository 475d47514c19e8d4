// Mirrored walls, friction and obstacles of the reference step.
#include "scenes.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm::test {
namespace {

/// The state of the first `count` particles must equal that of `whole` shifted by `shift` cells; returns the largest difference.
double difference(const ReferenceBody<double>& half, const ReferenceBody<double>& whole, const Point& shift, int dim) {
  double worst = 0;
  for (std::size_t p = 0; p < half.mass.size(); ++p) {
    for (int c = 0; c < dim; ++c) {
      worst = std::max(
          {worst, std::abs(half.position[p][c] + shift[c] - whole.position[p][c]), std::abs(half.velocity[p][c] - whole.velocity[p][c])});
      for (int a = 0; a < dim; ++a) worst = std::max(worst, std::abs(half.affine[p][c][a] - whole.affine[p][c][a]) / 10);
    }
    worst = std::max(worst, 1e2 * std::abs(half.compression[p] - whole.compression[p]));
  }
  return worst;
}

TEST_CASE("reference: a slip wall and a slip corner act as the mirror image of the material") {
  double worst = 0;
  for (const Scheme& scheme : every_scheme()) {
    // FLIP's change of velocity is counted from a node's own raw sums, so that it holds the wall's impulse; the mirrored blob has no wall.
    if (scheme.transfer == deck::Transfer::flip) continue;
    // A blob in the corner of slip walls …
    Model corner = empty_model(2, {8, 8, 1});
    use(corner, scheme);
    corner.bodies = {block(corner, "blob", fluid(20, 5), {0.5, 0.5, 0}, {3.5, 2.5, 0}, 2)};
    disturb(corner, corner.bodies[0], 2, 8);
    // … and the blob with its three mirror images, far from any wall.
    Model open = empty_model(2, {16, 16, 1});
    use(open, scheme);
    Body& all = open.bodies.emplace_back(corner.bodies[0]);
    const BodyState& seed = corner.bodies[0].initial;
    all.initial = {};
    for (const auto& [sx, sy] : {std::pair{1, 1}, {-1, 1}, {1, -1}, {-1, -1}})
      for (std::size_t p = 0; p < seed.mass.size(); ++p) {
        all.initial.position.push_back({8 + sx * seed.position[p][0], 8 + sy * seed.position[p][1], 0});
        all.initial.velocity.push_back({sx * seed.velocity[p][0], sy * seed.velocity[p][1], 0});
        all.initial.mass.push_back(seed.mass[p]);
        all.initial.compression.push_back(seed.compression[p]);
      }
    ReferenceState<double> a = reference_state<double>(corner), b = reference_state<double>(open);
    for (int step = 0; step < 20; ++step) reference_step<double>(corner, a, 5e-4), reference_step<double>(open, b, 5e-4);
    worst = std::max(worst, difference(a.bodies[0], b.bodies[0], {8, 8, 0}, 2));
    INFO(name_of(scheme));
    CHECK(worst < 1e-11);
  }
  WARN("largest difference between wall and mirror image after 20 steps: " << worst);
}

TEST_CASE("reference: impulses of walls and obstacles are the momentum that the step adds") {
  double worst = 0, friction = 0;
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme())
      for (int variant = 0; variant < 4; ++variant) {
        Model model = empty_model(dim, {5, 4, 4});
        use(model, scheme);
        model.gravity = {1, -9.81, 2};
        for (int face = 0; face < 6; ++face) {
          FaceLaw& law = model.faces[face];
          law.kind = deck::ContactKind((face + variant) % 4);
          law.segment_axis = (face / 2 + 1) % dim;
          law.to = {2, double(model.cells[law.segment_axis])};
          law.coefficient = {0.3, 0.6};
        }
        for (int kind = 0; kind < 4; ++kind)
          model.obstacles.push_back({"post",
                                     deck::ContactKind(kind),
                                     0.4,
                                     [kind](const Point& x) {
                                       const double dx = x[0] - 1 - kind, dy = x[1] - 2, r = std::hypot(dx, dy) + 1e-12;
                                       return SignedDistance{r - 0.8, {dx / r, dy / r, 0}};
                                     },
                                     {}});
        model.bodies = {block(model, "water", fluid(), {0, 0, 0}, {5, 4, 4}, 1), block(model, "jelly", jelly(), {1, 1, 0}, {4, 3, 3}, 1)};
        for (Body& body : model.bodies) {
          disturb(model, body, 3, 9);
          for (Point& x : body.initial.position)
            for (int a = 0; a < dim; ++a) x[a] = std::min(std::max(x[a], 0.05), model.cells[a] - 0.05);
        }
        ReferenceState<double> state = reference_state<double>(model);
        const Triple<double> before = total_momentum(state);
        const double dt = 1e-4, mass = total_mass(state);
        const auto report = reference_step<double>(model, state, dt);
        Triple<double> impulse{};
        for (int c = 0; c < dim; ++c) {
          impulse[c] = mass * model.gravity[c] * dt;
          for (const auto& [node, values] : report.grid) impulse[c] += dt * values.force[c];
          for (const auto& i : report.face_impulse) impulse[c] += i[c];
          for (const auto& i : report.obstacle_impulse) impulse[c] += i[c];
          worst = std::max(worst, std::abs(total_momentum(state)[c] - before[c] - impulse[c]) / mass);
        }
        friction += report.friction;
        INFO(name_of(scheme) << " in " << dim << "D, variant " << variant);
        CHECK(worst < 1e-12);
      }
  CHECK(friction > 0);
  WARN("largest difference between momentum gained and impulses, m/s: " << worst);
}

TEST_CASE("reference: material neither crosses nor slides where the wall forbids it") {
  for (const Scheme& scheme : every_scheme()) {
    Model model = empty_model(2, {6, 6, 1});
    use(model, scheme);
    model.faces[2].kind = deck::ContactKind::no_slip;
    model.faces[0].kind = deck::ContactKind::separate;
    model.faces[1].kind = deck::ContactKind::separate;
    model.bodies = {block(model, "blob", fluid(), {0, 0, 0}, {3, 3, 0}, 2)};
    disturb(model, model.bodies[0], 0, 3);
    for (Point& x : model.bodies[0].initial.position)
      for (int a = 0; a < 2; ++a) x[a] = std::max(x[a], 0.05);
    for (Point& v : model.bodies[0].initial.velocity) v = {2, 1, 0};
    ReferenceState<double> state = reference_state<double>(model);
    const auto report = reference_step<double>(model, state, 1e-4);
    INFO(name_of(scheme));
    for (const auto& [node, values] : report.grid) {
      if (node[1] == 0) CHECK((values.velocity[0] == 0 && values.velocity[1] == 0));
      if (node[0] == 0 && node[1] > 1) CHECK(values.velocity[0] > 1);  // leaves the separating wall
    }
    for (int c = 0; c < 3; ++c) CHECK(report.face_impulse[0][c] == 0);
  }
}

/// Largest speed over `seconds` of a water column started hydrostatic between slip walls, relative to √(gH).
double column_speed(const Scheme& scheme, double seconds) {
  const double g = 9.81, H = 0.2, c = 10 * std::sqrt(g * H);
  Model model = empty_model(2, {4, 26, 1}, 0.01);
  use(model, scheme);
  model.gravity = {0, -g, 0};
  model.bodies = {block(model, "water", fluid(c), {0, 0, 0}, {4, 20, 0}, 2)};
  BodyState& water = model.bodies[0].initial;
  for (std::size_t p = 0; p < water.mass.size(); ++p) {
    const double depth = H - water.position[p][1] * model.cell_size;
    water.compression[p] = std::exp(g * depth / (c * c)) - 1;  // dp/dz = −ρ g with p = c²(ρ − ρ0)
    water.mass[p] *= 1 + water.compression[p];
  }
  ReferenceState<double> state = reference_state<double>(model);
  const double dt = 0.4 * model.cell_size / c;
  double fastest = 0;
  for (int step = 0; step * dt < seconds; ++step) {
    reference_step<double>(model, state, dt);
    for (const auto& v : state.bodies[0].velocity) fastest = std::max(fastest, std::hypot(v[0], v[1]));
  }
  return fastest / std::sqrt(g * H);
}

TEST_CASE("reference: a hydrostatic water column stays at rest between mirrored walls") {
  using namespace deck;
  for (const Scheme& scheme :
       {Scheme{Transfer::apic, Basis::quadratic, GradientForm::spline}, Scheme{Transfer::apic, Basis::quadratic, GradientForm::mls},
        Scheme{Transfer::apic, Basis::cubic, GradientForm::spline}, Scheme{Transfer::tpic, Basis::quadratic, GradientForm::spline},
        Scheme{Transfer::flip, Basis::quadratic, GradientForm::spline}}) {
    const double speed = column_speed(scheme, 0.1);
    WARN(name_of(scheme) << ": largest speed " << speed << " sqrt(gH)");
    CHECK(speed < 3e-4);
  }
}

TEST_CASE("reference: a sliding block is slowed by mu g, and the floor's impulses are in that ratio") {
  const double g = 9.81, mu = 0.3, start = 1;
  Model model = empty_model(2, {24, 6, 1}, 0.1);
  model.gravity = {0, -g, 0};
  model.faces[2].kind = deck::ContactKind::friction;
  model.faces[2].coefficient = {mu};
  deck::LinearElastic stiff;
  stiff.density = 2000, stiff.youngs_modulus = 2e6, stiff.poisson_ratio = 0;
  model.bodies = {block(model, "block", stiff, {3, 0, 0}, {9, 3, 0}, 2)};
  BodyState& body = model.bodies[0].initial;
  for (std::size_t p = 0; p < body.mass.size(); ++p) {
    body.velocity[p] = {start, 0, 0};
    body.stress.push_back({0, -2000 * g * (3 - body.position[p][1]) * model.cell_size, 0, 0, 0, 0});
  }
  ReferenceState<double> state = reference_state<double>(model);
  const double mass = total_mass(state), dt = 1e-3, end = 0.2;
  Triple<double> floor{};
  for (int step = 0; step < std::lround(end / dt); ++step) {
    const auto report = reference_step<double>(model, state, dt);
    for (int c = 0; c < 2; ++c) floor[c] += report.face_impulse[2][c];
  }
  const double slowed = (start - total_momentum(state)[0] / mass) / end;
  WARN("deceleration " << slowed / (mu * g) << " mu g; impulse ratio " << -floor[0] / floor[1] / mu << " mu; weight carried "
                       << floor[1] / (mass * g * end));
  CHECK(slowed == Approx(mu * g).epsilon(0.02));
  CHECK(-floor[0] / floor[1] == Approx(mu).epsilon(0.02));
  CHECK(floor[1] == Approx(mass * g * end).epsilon(0.02));
}

TEST_CASE("reference: friction takes the coefficient of the segment a node lies in") {
  Model model = empty_model(2, {10, 4, 1}, 0.1);
  model.gravity = {0, -10, 0};
  model.faces[2].kind = deck::ContactKind::friction;
  model.faces[2].to = {4, 10};
  model.faces[2].coefficient = {0, 0.5};
  model.bodies = {block(model, "left", fluid(), {2, 0, 0}, {3, 1, 0}, 2), block(model, "right", fluid(), {6, 0, 0}, {8, 1, 0}, 2)};
  for (Body& body : model.bodies)
    for (Point& v : body.initial.velocity) v = {1, 0, 0};
  ReferenceState<double> state = reference_state<double>(model);
  reference_step<double>(model, state, 1e-3);
  for (const auto& v : state.bodies[0].velocity) CHECK(v[0] == Approx(1).epsilon(1e-14));
  CHECK(state.bodies[1].velocity[0][0] < 0.999);
}

}  // namespace
}  // namespace jaxmpm::test
