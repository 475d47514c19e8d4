// Directional derivatives of a whole run by dual numbers, and the errors of the reference step.
#include "core/error.hpp"
#include "scenes.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm::test {
namespace {

/// Sand and jelly on a friction floor beside a no-slip wall, with an obstacle.
Model scene(int dim) {
  Model model = empty_model(dim, {8, 7, 6});
  model.gravity = {0, -9.81, 0};
  model.faces[0].kind = deck::ContactKind::no_slip;
  model.faces[2].kind = deck::ContactKind::friction;
  model.faces[2].coefficient = {0.2};
  model.obstacles.push_back({"post",
                             deck::ContactKind::friction,
                             0.3,
                             [](const Point& x) {
                               return SignedDistance{5.0 - x[0], {-1, 0, 0}};
                             },
                             {}});
  deck::DruckerPrager sand;
  sand.density = 2000, sand.bulk_modulus = 5e5, sand.poisson_ratio = 0.3, sand.friction_angle = 30, sand.cohesion = 200;
  model.bodies = {block(model, "sand", sand, {0, 0, 1}, {3, 2, 3}, 2), block(model, "jelly", jelly(), {3, 0, 1}, {5, 2, 3}, 2)};
  disturb(model, model.bodies[0], 0.5, 21);
  disturb(model, model.bodies[1], 0.5, 22);
  for (Body& body : model.bodies)
    for (Point& x : body.initial.position)
      for (int a = 0; a < dim; ++a) x[a] = std::max(x[a], 0.05);
  return model;
}

template <class Scalar>
Scalar kick(const Model& model, Scalar size, int steps) {
  ReferenceState<Scalar> state = reference_state<Scalar>(model);
  for (auto& body : state.bodies)
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      body.velocity[p][0] += size * Scalar(std::sin(double(p)));
      body.position[p][1] += size * Scalar(0.1 * std::cos(double(p)));
    }
  for (int step = 0; step < steps; ++step) reference_step<Scalar>(model, state, Scalar(2e-4));
  Scalar sum(0);
  for (const auto& body : state.bodies)
    for (std::size_t p = 0; p < body.mass.size(); ++p)
      for (int c = 0; c < model.dim; ++c) sum += Scalar(std::sin(3.0 * double(p) + c)) * (body.velocity[p][c] + body.position[p][c]);
  return sum;
}

TEST_CASE("reference: the derivative of a run by dual numbers is that of differences") {
  for (const int dim : {2, 3})
    for (const Scheme& scheme : every_scheme()) {
      if (dim == 3 && scheme.basis != deck::Basis::quadratic) continue;
      Model model = scene(dim);
      use(model, scheme);
      const int steps = 3;
      const double h = 1e-6;
      const double exact = kick<ReferenceDual>(model, ReferenceDual::variable(0, 0), steps).derivative[0];
      const double differences = (kick<double>(model, h, steps) - kick<double>(model, -h, steps)) / (2 * h);
      INFO(name_of(scheme) << " in " << dim << "D");
      CHECK(exact == Approx(differences).epsilon(1e-6));
    }
}

TEST_CASE("reference: a particle that leaves the domain is an error that names it") {
  Model model = empty_model(2, {4, 4, 1});
  model.bodies = {block(model, "stone", jelly(), {1, 1, 0}, {2, 2, 0}, 1)};
  model.bodies[0].initial.velocity[0] = {100, 0, 0};
  ReferenceState<double> state = reference_state<double>(model);
  CHECK_THROWS_AS(reference_step<double>(model, state, 0.1), NumericsError);
  state.bodies[0].velocity[0][0] = std::nan("");
  CHECK_THROWS_AS(reference_step<double>(model, state, 1e-4), NumericsError);
}

TEST_CASE("reference: mls with linear splines is refused") {
  Model model = empty_model(2, {4, 4, 1});
  use(model, {deck::Transfer::apic, deck::Basis::linear, deck::GradientForm::mls});
  ReferenceState<double> state = reference_state<double>(model);
  CHECK_THROWS_AS(reference_step<double>(model, state, 1e-4), DeckError);
}

}  // namespace
}  // namespace jaxmpm::test
