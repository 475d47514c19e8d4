#pragma once
// The two measures of a front, along one coordinate s that grows towards it.
#include <functional>
#include <vector>

#include "observe/gauge.hpp"

namespace jaxmpm {

/// Amount of material (mass or volume) at a coordinate, m.
struct Along {
  double s, amount;
};

/// Smallest s behind which lies the share `quantile` of the amount; each particle counts as a step that is smooth over three `width`s
/// (sharp when 0).
Sample quantile_front(const std::vector<Along>& material, double quantile, double width, double cell_size);

/// Farthest s at which the depth falls below `depth`. Depth is Σ amount φ((s − s_p)/width)/width over breadth(s), the horizontal extent
/// across; φ is the quadratic spline or, when `width` is 0, one cell's box. Masked where the material is nowhere that deep.
Sample depth_front(const std::vector<Along>& material, double depth, double width, double cell_size,
                   const std::function<double(double)>& breadth);

}  // namespace jaxmpm
