#include "inverse/search_space.hpp"

#include <cmath>

namespace jaxmpm {

double SearchSpace::free_norm(const Variables& u, const Variables& gradient) const {
  double sum = 0;
  for (std::size_t i = 0; i < u.size(); ++i)
    if (!blocked(u, i, -gradient[i])) sum += gradient[i] * gradient[i];
  return std::sqrt(sum);
}

}  // namespace jaxmpm
