#pragma once
// From derivatives by the model to derivatives by numbers of the deck.
#include <map>
#include <string>
#include <vector>

#include "solvers/model_gradient.hpp"

namespace jaxmpm {

/// ∂L/∂(what each pointer names), exact: one value for a number, one for each weight of a network (/bodies/i/velocity/d/mlp, in the order
/// of fields/mlp.hpp), N × dim for the velocities of particles (/bodies/i/velocity/particles, in the order of ids). A number counts
/// wherever it enters: in the step, and through masses, initial stress and expressions in the first state (scene/initial_gradient.hpp).
/// `deck` is the one that `model` was built from, `gradient` that of the run. DeckError where a pointer names nothing that can be
/// differentiated by.
std::map<std::string, std::vector<double>> gradient_by_pointer(const deck::Deck& deck, const Model& model, const ModelGradient& gradient,
                                                               const std::vector<std::string>& pointers);

}  // namespace jaxmpm
