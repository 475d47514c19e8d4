#pragma once
// Height of a ground surface over the plane, in any one unit of length: bilinear between the centres of a raster, linear between the points
// of a profile.
#include <memory>
#include <vector>

namespace jaxmpm {

/// Height and its derivative along the first and second horizontal coordinate.
struct SurfaceSample {
  double height;
  double slope[2];
};

class Surface {
 public:
  virtual ~Surface() = default;
  /// Beyond its edges the surface goes on level.
  virtual SurfaceSample sample(double u, double v) const = 0;
  /// Least height above which every place over the rectangle is at least `reach` away from the surface, when the distance is measured as
  /// the vertical gap times the upward component of the surface's normal. reach 0: the greatest height.
  virtual double ceiling(double u_lower, double v_lower, double u_upper, double v_upper, double reach) const = 0;
};

/// Values at the centres (u0 + i·step, v0 + j·step) of a raster, i fastest; all finite.
struct Raster {
  double u0 = 0, v0 = 0, step = 1;
  int columns = 0, rows = 0;
  std::vector<double> value;
  double at(int i, int j) const { return value[static_cast<std::size_t>(j) * columns + i]; }
};

std::unique_ptr<Surface> make_raster_surface(Raster raster);
/// Heights over increasing u; the same for every v.
std::unique_ptr<Surface> make_profile_surface(std::vector<double> u, std::vector<double> height);

}  // namespace jaxmpm
