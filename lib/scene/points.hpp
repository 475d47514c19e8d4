#pragma once
// Particles that a file places one by one (shape "points").
#include "scene/geometry.hpp"

namespace jaxmpm {

/// In the order of the file's rows.
struct PlacedPoints {
  std::vector<Point> position;  // cells
  std::vector<double> volume;   // m³; in 2D m² (of a slice one metre thick)
  std::vector<int> lines;       // where each stands in the file
  std::string file;
};

/// For bodies that lie on a lattice, a cloud of points holds nothing: they are asked whether they hold it. Made by make_points(), which
/// reads the columns x, y[, z] (m) and volume of the file; DeckError for places outside the domain or given twice and for volumes that
/// cannot be, with the line; IoError for an unreadable file.
class PointsGeometry : public Geometry {
 public:
  PointsGeometry(PlacedPoints placed, int dim);
  void spans(const Point&, Spans& out) const override { out.clear(); }
  Bounds bounds() const override { return bounds_; }
  SignedDistance signed_distance(const Point&) const override;
  const PlacedPoints& placed() const { return placed_; }

 private:
  PlacedPoints placed_;
  Bounds bounds_;
};

}  // namespace jaxmpm
