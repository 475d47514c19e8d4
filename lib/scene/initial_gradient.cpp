#include "scene/initial_gradient.hpp"

#include <algorithm>

#include "fields/expression.hpp"
#include "fields/expression_derivative.hpp"
#include "fields/mlp.hpp"
#include "scene/initial_weight.hpp"

namespace jaxmpm {
namespace {

std::string velocity_pointer(std::size_t body, std::size_t axis) {
  return "/bodies/" + std::to_string(body) + "/velocity/" + std::to_string(axis);
}

/// m = ρ0 V (1 + e): change of a particle's mass with its density and compression.
double mass_slope(double mass, double density, double compression, double by_density, double by_compression) {
  return mass * (by_density / density + by_compression / (1 + compression));
}

const std::vector<deck::Component>* components_of(const deck::Body& body) {
  return std::get_if<std::vector<deck::Component>>(&body.velocity);
}

}  // namespace

InitialGradient::InitialGradient(const deck::Deck& deck, const Model& model, std::vector<const BodyState*> by_initial)
    : deck_(deck), model_(model), frame_(make_frame(deck)), by_initial_(std::move(by_initial)) {
  if (columns_needed(deck)) seeds_ = seed_bodies(deck, frame_, obstacle_shapes(deck, frame_)).seeds;
}

void InitialGradient::check_axis(const double& number) const {
  if (!columns_needed(deck_)) return;
  for (std::size_t d = 0; d < deck_.gravity.size(); ++d)
    if (&number == &deck_.gravity[d] && number == 0)
      throw DeckError("/gravity/" + std::to_string(d),
                      "cannot be an unknown with an initial stress by columns, which hold for gravity along its axis only; give the "
                      "initial_stress a \"surface\": { \"point\": […] }");
}

double InitialGradient::by_weight(const double& number) const {
  check_axis(number);
  double sum = 0;
  for (std::size_t b = 0; b < model_.bodies.size(); ++b) {  // mass at fixed compression
    const deck::Material& material = deck_.materials.at(deck_.bodies[b].material);
    const double& density = deck::reference_density(material);
    const std::vector<double>& by_mass = by_initial_[b]->mass;
    for (std::size_t p = 0; p < by_mass.size() && &density == &number; ++p)
      sum += by_mass[p] * mass_slope(model_.bodies[b].initial.mass[p], density, 0, 1, 0);
  }
  using Dual1 = Dual<double, 1>;
  spread_weight({deck_, frame_, seeds_, model_.bodies}, DeckNumberBy{&number},
                [&](std::size_t b, std::size_t p, const Dual1& compression, const std::array<Dual1, 6>& stress) {
                  const BodyState& by = *by_initial_[b];
                  const double slope = compression.derivative[0], mass = model_.bodies[b].initial.mass[p];
                  if (!by.mass.empty()) sum += by.mass[p] * mass_slope(mass, 1, compression.value, 0, slope);
                  if (!by.compression.empty()) sum += by.compression[p] * slope;
                  for (std::size_t k = 0; k < 6 && !by.stress.empty(); ++k) sum += by.stress[p][k] * stress[k].derivative[0];
                });
  return sum;
}

double InitialGradient::by_parameter(const std::string& name) const {
  double sum = 0;
  for (std::size_t b = 0; b < deck_.bodies.size(); ++b) {
    const auto* components = components_of(deck_.bodies[b]);
    for (std::size_t d = 0; components && !by_initial_[b]->velocity.empty() && d < components->size(); ++d) {
      const auto* text = std::get_if<std::string>(&(*components)[d]);
      if (!text) continue;
      const std::string pointer = velocity_pointer(b, d);
      const std::vector<std::string> used = Expression(*text, frame_.dim, deck_.parameters, pointer).parameters();
      if (std::find(used.begin(), used.end(), name) == used.end()) continue;
      const Expression slope(derivative_text(*text, name, pointer), frame_.dim, deck_.parameters, pointer);
      const std::vector<Point>& position = model_.bodies[b].initial.position;
      for (std::size_t p = 0; p < position.size(); ++p) sum += by_initial_[b]->velocity[p][d] * slope.value(frame_.metres(position[p]));
    }
  }
  return sum;
}

std::vector<double> InitialGradient::by_velocity(std::size_t body, int axis) const {
  const std::vector<Point>& by = by_initial_[body]->velocity;
  const deck::Component& component = components_of(deck_.bodies[body])->at(axis);
  const auto* network = std::get_if<deck::Mlp>(&component);
  if (!network) {
    double sum = 0;
    for (const Point& particle : by) sum += particle[axis];
    return {sum};
  }
  const Mlp mlp(*network, frame_.dim, velocity_pointer(body, axis) + "/mlp");
  std::vector<double> by_weights(mlp.weights().size(), 0.0);
  for (std::size_t p = 0; p < by.size(); ++p)
    mlp.add_gradient(frame_.metres(model_.bodies[body].initial.position[p]), by[p][axis], by_weights.data());
  return by_weights;
}

std::vector<double> InitialGradient::by_particle_velocities(std::size_t body) const {
  std::vector<double> by(model_.bodies[body].initial.id.size() * frame_.dim, 0.0);
  for (std::size_t p = 0; p < by_initial_[body]->velocity.size(); ++p)
    for (int a = 0; a < frame_.dim; ++a) by[p * frame_.dim + a] = by_initial_[body]->velocity[p][a];
  return by;
}

}  // namespace jaxmpm
