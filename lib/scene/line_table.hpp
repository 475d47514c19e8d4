#pragma once
// The material of all bodies along lines of gravity, by lattice cells.
#include <vector>

#include "scene/seeding.hpp"

namespace jaxmpm {

/// One piece of a body along a line, by depth coordinate (cells along gravity).
struct Piece {
  double top, bottom;
  std::size_t body;
};

/// A body's lattice cells, sorted into lines along gravity, which runs along an axis towards its upper (sign 1) or lower (−1) end.
class LineTable {
 public:
  LineTable(const Seeds& seeds, int axis, double sign, int dim, std::size_t body);
  /// Adds the pieces of the line through a place.
  void collect(const Point& place, std::vector<Piece>& pieces) const;
  std::uint64_t line_of(const Point& place) const;

 private:
  struct Entry {
    std::uint64_t line;
    std::int32_t first, last;
  };
  void add(const LatticeRun& run);
  void merge();

  Lattice lattice_;
  int axis_;
  double sign_;
  int dim_;
  std::size_t body_;
  std::vector<Entry> entries_;
};

}  // namespace jaxmpm
