// The adjoint of the step against the reference step on dual numbers: ⟨Jv, w⟩ = ⟨v, Jᵀw⟩ for every combination of scheme, material and
// wall.
#include <catch2/catch.hpp>

#include "reference/step.hpp"
#include "scenes.hpp"
#include "solvers/reversible_step.hpp"

using namespace jaxmpm;

namespace {

using Number = ReferenceDual;

/// Calls f(value, fast, slot, scale) for every number of a particle that a step depends on: the reference's, the fast stepper's, and the
/// size that numbers of this kind have.
template <int Dim, class F>
void for_each_number(ReferenceBody<Number>& slow, Particles<double, Dim>& fast, double cell_size, F f) {
  for (std::size_t a = 0; a < slow.mass.size(); ++a) {
    f(slow.mass[a], fast.mass[a], 0.1);
    f(slow.compression[a], fast.compression[a], 1e-3);
    if (!fast.dilation.empty()) f(slow.dilation[a], fast.dilation[0][a], 1e-3);
    for (std::size_t d = 0; d < Dim; ++d) {
      f(slow.position[a][d], fast.position[d][a], 0.01);  // cells: the way of a step
      f(slow.velocity[a][d], fast.velocity[d][a], 1.0);
      for (std::size_t k = 0; k < Dim && !fast.affine.empty(); ++k) f(slow.affine[a][d][k], fast.affine[d * Dim + k][a], 0.1 / cell_size);
    }
    for (std::size_t k = 0; k < slow.history[a].size(); ++k) f(slow.history[a][k], fast.history[k][a], 1.0);
  }
}

template <int Dim>
ReferenceState<Number> state_of(const Model& model, const std::vector<Particles<double, Dim>>& bodies) {
  ReferenceState<Number> state = reference_state<Number>(model);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Particles<double, Dim> copy = bodies[b];
    for_each_number<Dim>(state.bodies[b], copy, 1, [](Number& slow, double& fast, double) { slow = Number(fast); });
  }
  return state;
}

/// ⟨Jv, w⟩ − ⟨v, Jᵀw⟩ over ‖Jv‖‖w‖, in numbers of size one, for one step after a few.
template <int Dim>
double mismatch(const Model& model, double dt, int before) {
  ReversibleStep<double, Dim> solver(model);
  for (int k = 0; k < before; ++k) solver.step(dt);
  std::vector<std::byte> numbers(solver.kept_bytes());
  const std::unique_ptr<KeptState> start = solver.keep(numbers.data(), false);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  ReferenceState<Number> state = state_of<Dim>(model, solver.particles());
  std::vector<Particles<double, Dim>> direction = solver.particles();
  for (std::size_t b = 0; b < direction.size(); ++b)
    for_each_number<Dim>(state.bodies[b], direction[b], model.cell_size, [&](Number& slow, double& v, double scale) {
      v = scale * normal(random);
      slow.derivative[0] = v;
    });
  reference_step(model, state, Number(dt), before * dt);

  solver.start_reverse();
  double Jv_w = 0, Jv2 = 0, w2 = 0;
  for (std::size_t b = 0; b < direction.size(); ++b)
    for_each_number<Dim>(state.bodies[b], solver.bars()[b], model.cell_size, [&](Number& slow, double& bar, double scale) {
      const double w = normal(random);
      bar = w / scale;
      Jv_w += slow.derivative[0] * bar, Jv2 += std::pow(slow.derivative[0] / scale, 2), w2 += w * w;
    });
  solver.step_adjoint(dt, *start, numbers.data());
  solver.end_reverse();
  double v_Jtw = 0;
  for (std::size_t b = 0; b < direction.size(); ++b) {
    std::vector<double> v;
    for_each_number<Dim>(state.bodies[b], direction[b], model.cell_size, [&](Number&, double& x, double) { v.push_back(x); });
    std::size_t k = 0;
    for_each_number<Dim>(state.bodies[b], solver.bars()[b], model.cell_size, [&](Number&, double& bar, double) { v_Jtw += v[k++] * bar; });
  }
  return std::abs(Jv_w - v_Jtw) / std::sqrt(Jv2 * w2);
}

double mismatch(const Model& model, double dt, int before) {
  return model.dim == 2 ? mismatch<2>(model, dt, before) : mismatch<3>(model, dt, before);
}

constexpr double tolerance = 1e-14, dt = 2e-4;

void check_transpose(const Model& model, int before = 3) {
  const double off = mismatch(model, dt, before);
  CAPTURE(off);
  CHECK(off < tolerance);
}

/// Calls f(method) for every basis, transfer and form of the gradient that go together.
template <class F>
void for_each_scheme(F&& f) {
  using deck::Basis, deck::GradientForm, deck::Transfer;
  for (const Basis basis : {Basis::linear, Basis::quadratic, Basis::cubic})
    for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::tpic})
      for (const GradientForm gradient : {GradientForm::spline, GradientForm::mls}) {
        if (basis == Basis::linear && gradient == GradientForm::mls) continue;
        deck::Method method;
        method.basis = basis, method.transfer = transfer, method.gradient = gradient, method.precision = deck::Precision::f64;
        method.flip_fraction = 0.95;
        INFO(int(basis) << " basis, " << int(transfer) << " transfer, " << int(gradient) << " gradient");
        f(method);
      }
}

}  // namespace

TEST_CASE("the adjoint of a step is the transpose of its derivative: schemes") {
  for (const int dim : {2, 3})
    for_each_scheme([dim](const deck::Method& method) {
      INFO(dim << "D");
      check_transpose(busy_scene(dim, method, water(0.5), sand(), deck::ContactKind::friction));
    });
}

TEST_CASE("the adjoint of a step is the transpose of its derivative: body force, damping, moving walls, periodic faces") {
  using deck::ContactKind, deck::Transfer;
  for (const int dim : {2, 3})
    for (const Transfer transfer : {Transfer::flip, Transfer::apic})
      for (const ContactKind kind : {ContactKind::slip, ContactKind::no_slip, ContactKind::friction}) {
        deck::Method method;
        method.precision = deck::Precision::f64, method.transfer = transfer, method.flip_fraction = 0.95;
        INFO(dim << "D, " << int(transfer) << " transfer, wall " << int(kind));
        for (const Model& model :
             {driven(busy_scene(dim, method, water(0.5), sand(), kind)), periodic_scene(dim, method, water(0.5), elastic(), kind)})
          check_transpose(model);
      }
}

TEST_CASE("the adjoint of a step is the transpose of its derivative: materials and walls") {
  using deck::ContactKind;
  const std::vector<deck::Material> materials{water(), water(2.0), sand(), elastic(), rubber()};
  for (const int dim : {2, 3})
    for (const ContactKind kind : {ContactKind::slip, ContactKind::no_slip, ContactKind::separate, ContactKind::friction})
      for (std::size_t m = 0; m < materials.size(); ++m) {
        deck::Method method;
        method.precision = deck::Precision::f64;
        method.transfer = m % 2 == 0 ? deck::Transfer::apic : deck::Transfer::flip;
        INFO(dim << "D, material " << m << ", wall " << int(kind));
        check_transpose(busy_scene(dim, method, materials[m], materials[(m + 2) % materials.size()], kind));
      }
}

TEST_CASE("the adjoint of a step is the transpose of its derivative: particles that a face holds") {
  for (const int dim : {2, 3})
    for (const deck::Transfer transfer : {deck::Transfer::flip, deck::Transfer::apic}) {
      deck::Method method;
      method.precision = deck::Precision::f64, method.transfer = transfer;
      INFO(dim << "D, " << int(transfer) << " transfer");
      check_transpose(creeping_scene(dim, method), 0);
    }
}

TEST_CASE("the adjoint of a step is the transpose of its derivative: averaged changes of volume") {
  using deck::ContactKind;
  const std::vector<deck::Material> materials{water(), water(2.0), sand(), elastic(), rubber()};
  std::size_t m = 0;
  for (const int dim : {2, 3})
    for_each_scheme([&](deck::Method method) {
      method.volume_averaging = 0.7;
      const ContactKind wall = m % 2 ? ContactKind::friction : ContactKind::slip;
      INFO(dim << "D, wall " << int(wall));
      check_transpose(driven(busy_scene(dim, method, materials[m % 5], materials[(m + 2) % 5], wall)));
      ++m;
    });
}
