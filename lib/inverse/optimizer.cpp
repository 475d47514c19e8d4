#include "inverse/optimizer.hpp"

namespace jaxmpm {

std::string name_of(Ending ending) {
  return ending == Ending::converged ? "converged" : ending == Ending::iterations ? "iterations" : "stalled";
}

Ending minimise(const deck::Optimizer& optimizer, LossFunction& loss) {
  return std::visit([&loss](const auto& chosen) { return minimise(chosen, loss); }, optimizer);
}

}  // namespace jaxmpm
