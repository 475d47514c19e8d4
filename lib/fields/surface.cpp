#include "fields/surface.hpp"

#include <algorithm>
#include <cmath>

namespace jaxmpm {
namespace {

/// Interval of a sorted axis that holds a coordinate, and the place within it (0 … 1, clamped at both ends).
struct Place {
  int first;
  double fraction;
  bool outside;
};

Place locate(double coordinate, double origin, double step, int count) {
  const double index = (coordinate - origin) / step;
  const int first = static_cast<int>(std::clamp(std::floor(index), 0.0, std::max(0.0, count - 2.0)));
  const double fraction = std::clamp(index - first, 0.0, count > 1 ? 1.0 : 0.0);
  return {first, fraction, fraction != index - first};
}

class RasterSurface : public Surface {
 public:
  explicit RasterSurface(Raster raster) : raster_(std::move(raster)) {}

  SurfaceSample sample(double u, double v) const override {
    const Place a = locate(u, raster_.u0, raster_.step, raster_.columns), b = locate(v, raster_.v0, raster_.step, raster_.rows);
    const int i = a.first, j = b.first, i1 = std::min(i + 1, raster_.columns - 1), j1 = std::min(j + 1, raster_.rows - 1);
    const double z00 = raster_.at(i, j), z10 = raster_.at(i1, j), z01 = raster_.at(i, j1), z11 = raster_.at(i1, j1);
    const double s = a.fraction, t = b.fraction;
    const double south = z00 + s * (z10 - z00), north = z01 + s * (z11 - z01);
    const double along_u = a.outside ? 0 : ((1 - t) * (z10 - z00) + t * (z11 - z01)) / raster_.step;
    const double along_v = b.outside ? 0 : (north - south) / raster_.step;
    return {south + t * (north - south), {along_u, along_v}};
  }

  double ceiling(double u_lower, double v_lower, double u_upper, double v_upper, double reach) const override {
    const int i0 = locate(u_lower, raster_.u0, raster_.step, raster_.columns).first;
    const int i1 = locate(u_upper, raster_.u0, raster_.step, raster_.columns).first;
    const int j0 = locate(v_lower, raster_.v0, raster_.step, raster_.rows).first;
    const int j1 = locate(v_upper, raster_.v0, raster_.step, raster_.rows).first;
    double top = -1e300;
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) top = std::max(top, patch_ceiling(i, j, reach));
    return top;
  }

 private:
  /// A bilinear patch is nowhere above its corners, nor steeper along an axis than its steeper edge.
  double patch_ceiling(int i, int j, double reach) const {
    const int i1 = std::min(i + 1, raster_.columns - 1), j1 = std::min(j + 1, raster_.rows - 1);
    const double z00 = raster_.at(i, j), z10 = raster_.at(i1, j), z01 = raster_.at(i, j1), z11 = raster_.at(i1, j1);
    const double along_u = std::max(std::abs(z10 - z00), std::abs(z11 - z01)) / raster_.step;
    const double along_v = std::max(std::abs(z01 - z00), std::abs(z11 - z10)) / raster_.step;
    return std::max({z00, z10, z01, z11}) + reach * std::sqrt(1 + along_u * along_u + along_v * along_v);
  }

  Raster raster_;
};

class ProfileSurface : public Surface {
 public:
  ProfileSurface(std::vector<double> u, std::vector<double> height) : u_(std::move(u)), height_(std::move(height)) {}

  SurfaceSample sample(double u, double) const override {
    const std::size_t k = interval(u);
    const double slope = (height_[k + 1] - height_[k]) / (u_[k + 1] - u_[k]);
    const double inside = std::clamp(u, u_.front(), u_.back());
    return {height_[k] + slope * (inside - u_[k]), {inside == u ? slope : 0.0, 0.0}};
  }

  double ceiling(double u_lower, double, double u_upper, double, double reach) const override {
    double top = -1e300;
    for (std::size_t k = interval(u_lower); k <= interval(u_upper); ++k) {
      const double slope = (height_[k + 1] - height_[k]) / (u_[k + 1] - u_[k]);
      top = std::max(top, std::max(height_[k], height_[k + 1]) + reach * std::sqrt(1 + slope * slope));
    }
    return top;
  }

 private:
  std::size_t interval(double u) const {
    const auto next = std::upper_bound(u_.begin() + 1, u_.end() - 1, u);
    return static_cast<std::size_t>(next - u_.begin()) - 1;
  }

  std::vector<double> u_, height_;
};

}  // namespace

std::unique_ptr<Surface> make_raster_surface(Raster raster) { return std::make_unique<RasterSurface>(std::move(raster)); }

std::unique_ptr<Surface> make_profile_surface(std::vector<double> u, std::vector<double> height) {
  return std::make_unique<ProfileSurface>(std::move(u), std::move(height));
}

}  // namespace jaxmpm
