#pragma once
// Where an optimiser searches: as many variables as there are unknowns (a network has one for each weight), within bounds.
#include <algorithm>
#include <vector>

namespace jaxmpm {

using Variables = std::vector<double>;

struct SearchSpace {
  Variables start;
  Variables lower, upper;  // −∞ and ∞ where there is no bound
  Variables scale;         // a change that matters: the width of the bounds, or the size of the start

  std::size_t size() const { return start.size(); }
  /// The nearest variables within the bounds.
  Variables projected(Variables u) const {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::clamp(u[i], lower[i], upper[i]);
    return u;
  }
  /// Whether a variable lies on a bound beyond which `direction` (of its sign) would lead.
  bool blocked(const Variables& u, std::size_t i, double direction) const {
    return (u[i] <= lower[i] && direction < 0) || (u[i] >= upper[i] && direction > 0);
  }
  /// Length of the part of a gradient that descent can follow: components that lead out of the bounds do not count.
  double free_norm(const Variables& u, const Variables& gradient) const;
};

}  // namespace jaxmpm
