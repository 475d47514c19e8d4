#pragma once
// The lattice on which a body's particles are seeded, and the runs of its places that lie inside the body.
#include <cstdint>
#include <vector>

#include "scene/geometry.hpp"

namespace jaxmpm {

/// Places (n + ½)·spacing along every axis, counted from domain.min, in cells.
struct Lattice {
  double spacing = 0.5;  // cells
  int per_cell = 2;      // along each axis; 0 where the deck gives a spacing instead

  double place(std::int64_t n) const {
    if (per_cell == 0) return (static_cast<double>(n) + 0.5) * spacing;
    const std::int64_t cell = n >= 0 ? n / per_cell : -((per_cell - 1 - n) / per_cell);
    return static_cast<double>(cell) + (static_cast<double>(n - cell * per_cell) + 0.5) / per_cell;
  }
  /// Lower face of place n's lattice cell.
  double edge(std::int64_t n) const { return static_cast<double>(n) * spacing; }
  /// Least index whose place is at or above a coordinate.
  std::int64_t first_at_or_above(double coordinate) const;
};

/// Consecutive lattice places [first, last) of one column along the last axis; `column` are the indices along the other axes (the second
/// unused in 2D).
struct LatticeRun {
  std::int32_t column[2];
  std::int32_t first, last;
};

Lattice make_lattice(const deck::Body& body, const Frame& frame, const std::string& pointer);

}  // namespace jaxmpm
