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
/// A body's particles; those that do not count have the amount 0. `read` writes particles [begin, end).
struct Material {
  std::size_t count = 0;
  std::function<void(std::size_t begin, std::size_t end, Along* out)> read;
};

/// Derivatives of a front by one particle's coordinate (1) and amount (m per unit of amount).
struct AlongGradient {
  double by_s = 0, by_amount = 0;
};

/// Smallest s behind which lies the share `quantile` of the amount; each particle counts as a step that is smooth over three `width`s
/// (sharp when 0).
Sample quantile_front(const Material& material, double quantile, double width, double cell_size);

/// Farthest s at which the depth falls below `depth`. Depth is Σ amount φ((s − s_p)/width)/width over breadth(s), the horizontal extent
/// across; φ is the quadratic spline or, when `width` is 0, one cell's box. Masked where the material is nowhere that deep.
Sample depth_front(const Material& material, double depth, double width, double cell_size, const std::function<double(double)>& breadth);

/// Derivatives of both measures at the front `s` that they gave, by the implicit function theorem; `width` is above 0. Zeros where the
/// front sits on a jump and no particle moves it.
///   quantile: F = Σ a_p (S((s − s_p)/w) − q) = 0, S the spline's integral
///   depth:    F = Σ a_p φ((s − s_p)/w)/w − depth · breadth(s) = 0; `breadth` (m) and `breadth_slope` (1) are those at s
std::vector<AlongGradient> quantile_front_gradient(const Material& material, double s, double quantile, double width);
std::vector<AlongGradient> depth_front_gradient(const Material& material, double s, double depth, double width, double breadth,
                                                double breadth_slope);

}  // namespace jaxmpm
