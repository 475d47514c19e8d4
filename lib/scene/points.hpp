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

/// Reads the columns x, y[, z] (m) and volume. `pointer`: that of the points. DeckError for places outside the domain and volumes not above
/// 0, with the line; IoError for an unreadable file.
PlacedPoints read_points(const deck::Points& points, const Frame& frame, const std::string& pointer);

}  // namespace jaxmpm
