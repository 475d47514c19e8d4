#include "scene/overburden.hpp"

namespace jaxmpm {

double reference_density(const deck::Material& material) {
  return std::visit([](const auto& m) { return m.density; }, material);
}

}  // namespace jaxmpm
