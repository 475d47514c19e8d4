#pragma once
// How the first state depends on the numbers of the deck: exact derivatives at fixed seeding.
#include "scene/seeding.hpp"

namespace jaxmpm {

/// Chains derivatives of a loss by the first state (as the `initial` of solvers/model_gradient.hpp; empty fields are zero) back to numbers
/// of the deck. `deck` is the one that `model` was built from; both and the gradients have to outlive this.
class InitialGradient {
 public:
  InitialGradient(const deck::Deck& deck, const Model& model, std::vector<const BodyState*> by_initial);

  /// Through the mass, compression and stress of the particles, by a number that stands in the deck itself (by its address): a component of
  /// gravity, a number of a material, a k0. Forward mode: one pass over the particles. DeckError where gravity leaves the axis along which
  /// the weight is measured.
  double by_weight(const double& number) const;
  /// By a parameter of the deck, through the expressions of velocities. DeckError where one has no derivative.
  double by_parameter(const std::string& name) const;
  /// By a velocity component that is a number (one value) or a network (its weights).
  std::vector<double> by_velocity(std::size_t body, int axis) const;
  /// By the velocities of a body's particles, N × dim.
  std::vector<double> by_particle_velocities(std::size_t body) const;

 private:
  void check_axis(const double& number) const;

  const deck::Deck& deck_;
  const Model& model_;
  Frame frame_;
  std::vector<Seeds> seeds_;  // only where depth is measured along lines of material
  std::vector<const BodyState*> by_initial_;
};

}  // namespace jaxmpm
