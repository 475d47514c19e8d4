// Gradients of whole runs against central differences, and what they must not depend on: the budget of memory and disk.
#include "inverse/differentiated_run.hpp"

#include <catch2/catch.hpp>
#include <map>

#include "fields/body_force.hpp"
#include "inverse/checkpoint_schedule.hpp"
#include "solvers/scenes.hpp"

using namespace jaxmpm;

namespace {

/// Σ over its times of a fixed combination of positions, velocities, densities and stresses, so that every one matters.
class Everything : public Observer {
 public:
  explicit Everything(std::vector<double> times) : times_(std::move(times)) {}
  const std::vector<double>& times() const override { return times_; }
  FieldSelection needs() const override {
    FieldSelection fields;
    fields.velocity = fields.density = fields.stress = true;
    return fields;
  }
  void look(std::size_t index, const Moment&, const std::vector<BodySnapshot>& bodies) override {
    if (index == 0) loss_ = size_ = 0;
    const auto add = [&](double term) { loss_ += term, size_ += std::abs(term); };
    const SnapshotGradient by = combination(bodies);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      for (std::size_t i = 0; i < bodies[b].position.size(); ++i)
        add(by[b].position[i] * bodies[b].position[i]), add(by[b].velocity[i] * bodies[b].velocity[i]);
      for (std::size_t i = 0; i < bodies[b].density.size(); ++i) add(by[b].density[i] * bodies[b].density[i]);
      for (std::size_t i = 0; i < bodies[b].stress.size(); ++i) add(by[b].stress[i] * bodies[b].stress[i]);
    }
    last_ = by;
  }
  double loss() const override { return loss_; }
  /// Sum of the sizes of all terms of the loss.
  double size() const { return size_; }
  const std::vector<double>& residuals() const override { return residuals_; }
  SnapshotGradient gradient(std::size_t) const override { return last_; }

 private:
  static SnapshotGradient combination(const std::vector<BodySnapshot>& bodies) {
    SnapshotGradient by(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto waves = [&](std::size_t n, double size, double phase) {
        std::vector<double> w(n);
        for (std::size_t i = 0; i < n; ++i) w[i] = size * std::sin(0.37 * double(i) + phase);
        return w;
      };
      by[b].position = waves(bodies[b].position.size(), 10, 0.1), by[b].velocity = waves(bodies[b].velocity.size(), 1, 0.7);
      by[b].density = waves(bodies[b].density.size(), 0.01, 0.3), by[b].stress = waves(bodies[b].stress.size(), 1e-3, 1.9);
    }
    return by;
  }
  std::vector<double> times_, residuals_;
  double loss_ = 0, size_ = 0;
  SnapshotGradient last_;
};

Model scene(int dim, deck::Transfer transfer, const deck::Material& first, const deck::Material& second, deck::ContactKind kind) {
  deck::Method method;
  method.transfer = transfer, method.precision = deck::Precision::f64, method.flip_fraction = 0.9;
  Model model = busy_scene(dim, method, first, second, kind);
  model.time.step = 1e-4, model.time.end = 1;
  return model;
}

ModelGradient gradient_of(const Model& model, const StepSequence& steps, Observer& observer, std::size_t snapshots, std::size_t on_disk = 0,
                          bool lean = false) {
  MemoryPlan plan;
  plan.steps = steps.dt.size(), plan.snapshots = snapshots, plan.on_disk = on_disk, plan.lean = lean ? snapshots / 2 : 0,
  plan.whole_snapshots = 5;
  RunCost cost;
  SnapshotStack stack(make_state_memory(Backend::cpu));
  return differentiate_run(model, steps, observer, plan, stack, cost, {});
}

/// Central difference of the loss by a number of the model, over the same steps, and what round-off leaves uncertain of it.
struct Difference {
  double value, uncertain;
};
Difference difference(const Model& model, const StepSequence& steps, Everything& observer, const std::function<double&(Model&)>& number,
                      double change) {
  double loss[2];
  for (const int side : {0, 1}) {
    Model other = model;
    number(other) += side == 0 ? -change : change;
    replay_run(other, Backend::cpu, steps, observer, {});
    loss[side] = observer.loss();
  }
  return {(loss[1] - loss[0]) / (2 * change), 2e-15 * observer.size() / change};
}

struct Number {
  std::function<double&(Model&)> number;
  double change, gradient;
};

/// Numbers of the model that enter the step, with their derivatives.
std::map<std::string, Number> numbers(const Model& model, const ModelGradient& g) {
  std::map<std::string, Number> all;
  all["gravity"] = {[](Model& m) -> double& { return m.gravity[1]; }, 1e-4, g.gravity[1]};
  for (const std::size_t face : {std::size_t(0), std::size_t(2)})
    for (std::size_t k = 0; k < model.faces[face].coefficient.size(); ++k)
      all["face " + std::to_string(face) + " segment " + std::to_string(k)] = {
          [=](Model& m) -> double& { return m.faces[face].coefficient[k]; }, 1e-6, g.coefficient[face][k]};
  all["obstacle"] = {[](Model& m) -> double& { return m.obstacles[0].coefficient; }, 1e-6, g.obstacle_coefficient[0]};
  all["velocity of 3"] = {[](Model& m) -> double& { return m.bodies[0].initial.velocity[3][1]; }, 1e-5, g.bodies[0].initial.velocity[3][1]};
  all["mass of 5"] = {[](Model& m) -> double& { return m.bodies[0].initial.mass[5]; }, 1e-6, g.bodies[0].initial.mass[5]};
  all["compression of 7"] = {[](Model& m) -> double& { return m.bodies[0].initial.compression[7]; }, 1e-8,
                             g.bodies[0].initial.compression[7]};
  all["stress of 9"] = {[](Model& m) -> double& { return m.bodies[1].initial.stress[9][3]; }, 1e-2, g.bodies[1].initial.stress[9][3]};
  return all;
}

void check(const Model& model, const std::map<std::string, Number>& all, const StepSequence& steps, Everything& observer) {
  for (const auto& [name, n] : all) {
    const Difference measured = difference(model, steps, observer, n.number, n.change);
    INFO(name << ": gradient " << n.gradient << ", central difference " << measured.value << " ± " << measured.uncertain);
    CHECK(std::abs(n.gradient - measured.value) <= 1e-6 * std::abs(measured.value) + measured.uncertain);
  }
}

template <class Material>
Number material_number(std::size_t body, double Material::*member, double change, const std::string& key, const ModelGradient& g) {
  return {[=](Model& m) -> double& { return std::get<Material>(m.bodies[body].material).*member; }, change,
          g.bodies[body].material.at(key)};
}

}  // namespace

TEST_CASE("gradients of a run agree with central differences") {
  const int dim = GENERATE(2, 3);
  const auto transfer = GENERATE(deck::Transfer::apic, deck::Transfer::flip);
  const auto kind = GENERATE(deck::ContactKind::friction, deck::ContactKind::no_slip);
  const Model model = scene(dim, transfer, water(2), elastic(), kind);
  Everything observer({0, 4e-4, 1e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  CHECK(steps.dt.size() == 10);
  const ModelGradient g = gradient_of(model, steps, observer, 4);
  CAPTURE(dim, int(transfer), int(kind));
  auto all = numbers(model, g);
  all["density"] = material_number(0, &deck::Newtonian::density, 1e-3, "density", g);
  all["sound speed"] = material_number(0, &deck::Newtonian::sound_speed, 1e-5, "sound_speed", g);
  all["viscosity"] = material_number(0, &deck::Newtonian::viscosity, 1e-4, "viscosity", g);
  all["Young's modulus"] = material_number(1, &deck::LinearElastic::youngs_modulus, 1, "youngs_modulus", g);
  all["Poisson's ratio"] = material_number(1, &deck::LinearElastic::poisson_ratio, 1e-6, "poisson_ratio", g);
  if (transfer == deck::Transfer::flip)
    all["flip fraction"] = {[](Model& m) -> double& { return m.method.flip_fraction; }, 1e-6, g.flip_fraction};
  check(model, all, steps, observer);
}

TEST_CASE("gradients by a granular material's numbers agree with central differences") {
  deck::DruckerPrager loam = sand();
  loam.cohesion = 200;
  const Model model = scene(2, deck::Transfer::apic, loam, rubber(), deck::ContactKind::friction);
  Everything observer({1e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient g = gradient_of(model, steps, observer, 3);
  auto all = numbers(model, g);
  all["friction angle"] = material_number(0, &deck::DruckerPrager::friction_angle, 1e-6, "friction_angle", g);
  all["dilation angle"] = material_number(0, &deck::DruckerPrager::dilation_angle, 1e-6, "dilation_angle", g);
  all["cohesion"] = material_number(0, &deck::DruckerPrager::cohesion, 1e-5, "cohesion", g);
  all["density"] = material_number(0, &deck::DruckerPrager::density, 1e-4, "density", g);
  all["rubber's Young's modulus"] = material_number(1, &deck::NeoHookean::youngs_modulus, 1, "youngs_modulus", g);
  all["rubber's Poisson's ratio"] = material_number(1, &deck::NeoHookean::poisson_ratio, 1e-7, "poisson_ratio", g);
  check(model, all, steps, observer);
}

TEST_CASE("gradients by damping and by the numbers of a body force agree with central differences") {
  const int dim = GENERATE(2, 3);
  const auto transfer = GENERATE(deck::Transfer::apic, deck::Transfer::flip);
  const auto kind = GENERATE(deck::ContactKind::friction, deck::ContactKind::no_slip);
  CAPTURE(dim, int(transfer), int(kind));
  struct Numbers {
    double damping, upward, a, k;
  };
  const auto model_with = [&](const Numbers& n) {
    Model model = scene(dim, transfer, water(2), elastic(), kind);
    const std::vector<deck::Formula> components{"a*sin(k*x + 300*t) + abs(y)", n.upward, "k*y"};
    model.body_force = std::make_shared<const BodyForce>(std::vector<deck::Formula>(components.begin(), components.begin() + dim), dim,
                                                         std::map<std::string, double>{{"a", n.a}, {"k", n.k}});
    model.method.damping = n.damping;
    return model;
  };
  const Numbers start{300, 4, 5, 20};
  const Model model = model_with(start);
  Everything observer({4e-4, 1e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient g = gradient_of(model, steps, observer, 4);
  REQUIRE(model.body_force->parameters() == std::vector<std::string>{"a", "k"});
  REQUIRE(g.body_force.size() == 5);
  const auto check_number = [&](double Numbers::*number, double change, double gradient) {
    double loss[2];
    for (const int side : {0, 1}) {
      Numbers other = start;
      other.*number += side == 0 ? -change : change;
      replay_run(model_with(other), Backend::cpu, steps, observer, {});
      loss[side] = observer.loss();
    }
    const double measured = (loss[1] - loss[0]) / (2 * change);
    INFO("gradient " << gradient << ", central difference " << measured);
    CHECK(std::abs(gradient - measured) <= 1e-6 * std::abs(measured) + 2e-15 * observer.size() / change);
  };
  check_number(&Numbers::damping, 1e-3, g.damping);
  check_number(&Numbers::upward, 1e-4, g.body_force[1]);
  check_number(&Numbers::a, 1e-4, g.body_force[3]);
  check_number(&Numbers::k, 1e-4, g.body_force[4]);
}

TEST_CASE("gradients of a body that rests on what rubs it are those of sticking") {
  const int dim = GENERATE(2, 3);
  const auto transfer = GENERATE(deck::Transfer::apic, deck::Transfer::flip);
  const double along = GENERATE(0.0, 0.3);  // of the wall, and of the body with it
  CAPTURE(dim, int(transfer), along);
  Model model = scene(dim, transfer, water(2), elastic(), deck::ContactKind::friction);
  model.bodies.resize(1), model.obstacles.clear();
  model.gravity = {0, 0, 0};
  model.gravity[1] = -9;
  BodyState& body = model.bodies[0].initial;
  for (std::size_t p = 0; p < body.id.size(); ++p) {
    body.position[p][0] += 3, body.velocity[p] = {along, -0.3, 0}, body.compression[p] = 0;
    if (!body.stress.empty()) body.stress[p] = {};
  }
  if (dim == 3)
    for (Point& place : body.position) place[2] += 2;
  model.faces[2].coefficient = {0.6}, model.faces[2].to = {1e3}, model.faces[2].velocity = {along, 0, 0};
  Everything observer({1e-4});  // one step, in which nothing but the floor acts along x
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient g = gradient_of(model, steps, observer, 1);
  std::size_t lowest = 0;
  for (std::size_t p = 0; p < body.id.size(); ++p)
    if (body.position[p][1] < body.position[lowest][1]) lowest = p;
  check(model,
        {{"velocity",
          {[=](Model& m) -> double& { return m.bodies[0].initial.velocity[lowest][0]; }, 1e-5, g.bodies[0].initial.velocity[lowest][0]}},
         {"wall", {[](Model& m) -> double& { return m.faces[2].velocity[0]; }, 1e-5, g.wall_velocity[2][0]}}},
        steps, observer);
}

TEST_CASE("gradients in single precision are those in double precision to within rounding") {
  const int dim = GENERATE(2, 3);
  const auto transfer = GENERATE(deck::Transfer::pic, deck::Transfer::flip, deck::Transfer::apic, deck::Transfer::tpic);
  const auto basis = GENERATE(deck::Basis::linear, deck::Basis::quadratic, deck::Basis::cubic);
  const bool soil = (int(transfer) + int(basis)) % 2 == 1;
  CAPTURE(dim, int(transfer), int(basis), soil);
  Model model = soil ? scene(dim, transfer, sand(), rubber(), deck::ContactKind::friction)
                     : driven(scene(dim, transfer, water(2), elastic(), deck::ContactKind::no_slip));
  model.method.basis = basis, model.method.volume_averaging = soil ? 0.5 : 0;
  Everything observer({4e-4, 2e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient exact = gradient_of(model, steps, observer, 4);
  model.method.precision = deck::Precision::f32;
  const ModelGradient single = gradient_of(model, steps, observer, 4);

  // A grain that yields, or slips, within rounding of not doing so takes the other branch: that moves sums over soil by more.
  const double tolerance = soil ? 5e-3 : 1e-3;
  const auto close = [=](double a, double b, double size) { return std::abs(a - b) <= tolerance * std::max(std::abs(b), size); };
  double by_walls = 0;  // the largest: sums over nodes of either sign are as uncertain everywhere
  for (const Point& face : exact.wall_velocity)
    for (const double by : face) by_walls = std::max(by_walls, std::abs(by));
  for (std::size_t c = 0; c < std::size_t(dim); ++c) CHECK(close(single.gravity[c], exact.gravity[c], std::abs(exact.gravity[1])));
  CHECK(close(single.damping, exact.damping, 0));
  for (std::size_t f = 0; f < 6; ++f) {
    for (std::size_t k = 0; k < exact.coefficient[f].size(); ++k) CHECK(close(single.coefficient[f][k], exact.coefficient[f][k], 1e-3));
    for (std::size_t c = 0; c < 3; ++c) CHECK(close(single.wall_velocity[f][c], exact.wall_velocity[f][c], 0.1 * by_walls));
  }
  for (std::size_t b = 0; b < exact.bodies.size(); ++b) {
    for (const auto& [key, value] : exact.bodies[b].material) {
      INFO(key << ": " << single.bodies[b].material.at(key) << ", " << value);
      CHECK(close(single.bodies[b].material.at(key), value, 0));
    }
    double off = 0, size = 0;
    for (std::size_t p = 0; p < exact.bodies[b].initial.velocity.size(); ++p)
      for (std::size_t d = 0; d < 3; ++d) {
        const double v = exact.bodies[b].initial.velocity[p][d];
        off += std::pow(single.bodies[b].initial.velocity[p][d] - v, 2), size += v * v;
      }
    CHECK(std::sqrt(off / size) <= 1e-4);
  }
}

TEST_CASE("gradients by the velocities of walls agree with central differences") {
  const int dim = GENERATE(2, 3);
  const auto transfer = GENERATE(deck::Transfer::apic, deck::Transfer::flip);
  const auto kind = GENERATE(deck::ContactKind::friction, deck::ContactKind::no_slip);
  const bool mixed = GENERATE(false, true);  // walls that hold beside ones that rub
  CAPTURE(dim, int(transfer), int(kind), mixed);
  Model model = scene(dim, transfer, water(2), elastic(), kind);
  for (std::size_t f = 0; mixed && f < 2 * std::size_t(dim); f += 3) {
    FaceLaw& other = model.faces[f];
    other.kind = kind == deck::ContactKind::friction ? deck::ContactKind::no_slip : deck::ContactKind::friction;
    other.coefficient = {}, other.to = {};
    if (other.kind == deck::ContactKind::friction) other.coefficient = {0.4}, other.to = {1e3};
  }
  model = driven(model);
  Everything observer({4e-4, 1e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient g = gradient_of(model, steps, observer, 4);
  std::map<std::string, Number> all;
  for (std::size_t f = 0; f < 2 * std::size_t(dim); ++f)
    for (std::size_t c = 0; c < std::size_t(dim); ++c)
      if (c != f / 2)
        all["face " + std::to_string(f) + " along " + std::to_string(c)] = {[=](Model& m) -> double& { return m.faces[f].velocity[c]; },
                                                                            1e-5, g.wall_velocity[f][c]};
  check(model, all, steps, observer);
}

TEST_CASE("gradients by a body force that is not finite where no material is") {
  Model model = scene(2, deck::Transfer::apic, water(2), elastic(), deck::ContactKind::friction);
  double right = 0;  // of all material, cells
  for (const Body& body : model.bodies)
    for (const Point& X : body.initial.position) right = std::max(right, X[0]);
  const double end = model.domain_min[0] + model.cell_size * (right + 3);  // beyond all nodes with mass
  model.body_force = std::make_shared<const BodyForce>(std::vector<deck::Formula>{"a*sqrt(" + std::to_string(end) + " - x)", 0.0}, 2,
                                                       std::map<std::string, double>{{"a", 5}});
  Everything observer({1e-3});
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  const ModelGradient g = gradient_of(model, steps, observer, 4);
  REQUIRE(g.body_force.size() == 4);
  CHECK(std::isfinite(g.body_force[3]));
  CHECK(g.body_force[3] != 0);
}

TEST_CASE("gradients of a run that sorts its particles on the way agree with central differences") {
  Model model = scene(2, deck::Transfer::tpic, elastic(), elastic(), deck::ContactKind::slip);
  model.obstacles.resize(0);
  model.time.step = 2e-4;
  Everything observer({6e-3, 2.2e-2});  // 110 steps; particles cross more than a cell
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  REQUIRE(steps.sorts > 1);
  const ModelGradient g = gradient_of(model, steps, observer, steps.dt.size(), 0, true);
  check(model,
        {{"gravity", {[](Model& m) -> double& { return m.gravity[1]; }, 1e-4, g.gravity[1]}},
         {"velocity of 3",
          {[](Model& m) -> double& { return m.bodies[0].initial.velocity[3][1]; }, 1e-4, g.bodies[0].initial.velocity[3][1]}},
         {"Young's modulus", material_number(1, &deck::LinearElastic::youngs_modulus, 0.3, "youngs_modulus", g)}},
        steps, observer);
}

TEST_CASE("a gradient has the same bits whatever memory and disk it is given, whatever is kept and whatever is made again") {
  const auto transfer = GENERATE(deck::Transfer::pic, deck::Transfer::flip, deck::Transfer::apic, deck::Transfer::tpic);
  const int dim = GENERATE(2, 3);
  Model model = scene(dim, transfer, water(), sand(), deck::ContactKind::friction);
  model.method.precision = GENERATE(deck::Precision::f64, deck::Precision::f32);
  model.method.gradient = GENERATE(deck::GradientForm::spline, deck::GradientForm::mls);
  CAPTURE(int(transfer), dim, int(model.method.precision), int(model.method.gradient));
  if (dim == 3 && (transfer != deck::Transfer::apic || model.method.gradient == deck::GradientForm::mls)) return;
  model.time.step = {};
  model.time.cfl = 0.5;
  Everything observer({0.01, 0.02, transfer == deck::Transfer::pic ? 0.05 : 0.03});  // PIC slows what moves
  const StepSequence steps = record_run(model, Backend::cpu, observer, {});
  REQUIRE(steps.dt.size() > 30);
  REQUIRE(steps.sorts > 2);
  const ModelGradient whole = gradient_of(model, steps, observer, steps.dt.size());
  struct Case {
    std::size_t snapshots, on_disk, blocks;
    bool lean = false;
  };
  const std::size_t all = steps.dt.size(), most = steps.most_blocks;
  REQUIRE(most > 2);
  for (const Case c : {Case{2, 0, most},
                       {3, 0, most},
                       {5, 0, most},
                       {11, 0, most},
                       {2, 1, most},
                       {5, 4, most},
                       {11, 3, most},
                       {all, 20, most},
                       {all, 0, most, true},
                       {all, 0, 2, true},
                       {all, 0, 0},
                       {all, 0, 2},
                       {all, 0, most / 2}}) {
    if (transfer != deck::Transfer::apic && !c.lean && c.snapshots != 5) continue;  // it takes a while
    INFO(c.snapshots << " snapshots, " << c.on_disk << " of them on disk, room for the sums of " << c.blocks
                     << " blocks, lean: " << c.lean);
    StepSequence with_room = steps;
    with_room.most_blocks = c.blocks;
    const ModelGradient part = gradient_of(model, with_room, observer, c.snapshots, c.on_disk, c.lean);
    CHECK(part.gravity == whole.gravity);
    CHECK(part.coefficient == whole.coefficient);
    CHECK(part.flip_fraction == whole.flip_fraction);
    CHECK(part.bodies[1].initial.mass == whole.bodies[1].initial.mass);
    CHECK(part.bodies[1].material == whole.bodies[1].material);
    CHECK(part.bodies[0].material == whole.bodies[0].material);
    CHECK(part.bodies[0].initial.velocity == whole.bodies[0].initial.velocity);
    CHECK(part.bodies[1].initial.stress == whole.bodies[1].initial.stress);
  }
}

TEST_CASE("the schedule of snapshots costs as little as any") {
  // Fewest forward steps by dynamic programming: F(n, s) = min over m of m + F(n − m, s − 1) + F(m, s), F(1, s) = 0.
  constexpr std::size_t most_steps = 60, most_free = 8;
  double F[most_steps + 1][most_free + 1];
  for (std::size_t s = 0; s <= most_free; ++s)
    for (std::size_t n = 1; n <= most_steps; ++n) {
      F[n][s] = n == 1 ? 0 : 1e9;
      for (std::size_t m = 1; s > 0 && m < n; ++m) F[n][s] = std::min(F[n][s], double(m) + F[n - m][s - 1] + F[m][s]);
    }
  for (std::size_t free = 1; free <= most_free; ++free)
    for (std::size_t steps = 2; steps <= most_steps; ++steps) {
      INFO(steps << " steps, " << free + 1 << " snapshots");
      CHECK(recomputed_steps(steps, free + 1) == F[steps][free] + 1 - double(steps));
    }
}
