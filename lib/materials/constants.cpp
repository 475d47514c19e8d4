#include "materials/constants.hpp"

namespace jaxmpm {

std::map<std::string, double> by_material_numbers(const deck::Material& material, const double* by_constants) {
  std::map<std::string, double> by;
  const MaterialNumbers numbers = std::visit([](const auto& m) { return material_numbers(m); }, material);
  for (const auto& [key, number] : numbers)
    by[key] = with_law<Dual<double, 1>>(
        material,
        [&](const auto& law) {
          double sum = 0;
          const auto constants = std::decay_t<decltype(law)>::constants(law);
          for (std::size_t k = 0; k < constants.size(); ++k)
            if (const double slope = constants[k]->derivative[0]; slope != 0) sum += by_constants[k] * slope;
          return sum;
        },
        DeckNumberBy{number});
  return by;
}

}  // namespace jaxmpm
