#pragma once
// The quadratic B-spline as a smooth weight of observations (Du & He 2025, Eq 5), its integral, and both with the mirror images of walls.
#include <cmath>

namespace jaxmpm {

/// Widths beyond which the weight vanishes.
inline constexpr double reach = 1.5;

/// Weight at distance r, in widths; its integral over r is 1 and it vanishes beyond `reach`.
inline double spline(double r) {
  r = std::abs(r);
  if (r < 0.5) return 0.75 - r * r;
  return r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0;
}

/// Derivative of the weight by r.
inline double spline_slope(double r) {
  const double distance = std::abs(r);
  if (distance < 0.5) return -2 * r;
  return distance < 1.5 ? std::copysign(1.5 - distance, -r) : 0;
}

/// Integral of the weight from −∞ to r: a step from 0 to 1 that is smooth over three widths.
inline double spline_step(double r) {
  if (r <= -1.5) return 0;
  if (r >= 1.5) return 1;
  const double cube = (1.5 - std::abs(r)) * (1.5 - std::abs(r)) * (1.5 - std::abs(r));
  if (r < -0.5) return cube / 6;
  return r < 0.5 ? 0.5 + 0.75 * r - r * r * r / 3 : 1 - cube / 6;
}

/// Weight at x of material at xp between walls at `low` and `high`, with its mirror images behind them, so that a full column weighs as
/// much beside a wall.
inline double mirrored_spline(double x, double xp, double low, double high, double width) {
  return spline((x - xp) / width) + spline((x - (2 * low - xp)) / width) + spline((x - (2 * high - xp)) / width);
}

/// Derivatives of mirrored_spline by x and by xp, 1/m.
struct MirroredSlope {
  double by_x, by_xp;
};
inline MirroredSlope mirrored_spline_slope(double x, double xp, double low, double high, double width) {
  const double own = spline_slope((x - xp) / width) / width;
  const double images = (spline_slope((x - (2 * low - xp)) / width) + spline_slope((x - (2 * high - xp)) / width)) / width;
  return {images + own, images - own};
}

}  // namespace jaxmpm
