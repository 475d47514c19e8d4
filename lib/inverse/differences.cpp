#include "inverse/differences.hpp"

namespace jaxmpm {

Difference difference(const Unknowns& unknowns, const Objective& objective, const Variables& u, std::size_t variable, double h) {
  const auto allowed = [&](double offset) {
    Variables moved = u;
    moved[variable] += offset;
    const SearchSpace& space = unknowns.space();
    return moved[variable] >= space.lower[variable] && moved[variable] <= space.upper[variable] && objective.admits(unknowns.values(moved));
  };
  if (!allowed(-h)) return {{0, h, 2 * h}, {-1.5 / h, 2 / h, -0.5 / h}};
  if (!allowed(h)) return {{0, -h, -2 * h}, {1.5 / h, -2 / h, 0.5 / h}};
  return {{-h, h}, {-0.5 / h, 0.5 / h}};
}

}  // namespace jaxmpm
