#include "scene/line_table.hpp"

#include <algorithm>
#include <cmath>

namespace jaxmpm {
namespace {

std::uint64_t line_index(std::int32_t a, std::int32_t b) {
  return b < 0 ? static_cast<std::uint32_t>(a)
               : (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

}  // namespace

LineTable::LineTable(const Seeds& seeds, int axis, double sign, int dim, std::size_t body)
    : lattice_(seeds.lattice), axis_(axis), sign_(sign), dim_(dim), body_(body) {
  for (const LatticeRun& run : seeds.runs) add(run);
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.line != b.line ? a.line < b.line : a.first < b.first; });
  merge();
}

void LineTable::collect(const Point& place, std::vector<Piece>& pieces) const {
  const std::uint64_t line = line_of(place);
  auto entry = std::lower_bound(entries_.begin(), entries_.end(), line, [](const Entry& e, std::uint64_t l) { return e.line < l; });
  for (; entry != entries_.end() && entry->line == line; ++entry) {
    const double a = sign_ * lattice_.edge(entry->first), b = sign_ * lattice_.edge(entry->last);
    pieces.push_back({std::min(a, b), std::max(a, b), body_});
  }
}

std::uint64_t LineTable::line_of(const Point& place) const {
  std::uint64_t line = 0;
  for (int d = 0; d < dim_; ++d)
    if (d != axis_) line = (line << 32) | static_cast<std::uint32_t>(std::max(0.0, std::floor(place[d] / lattice_.spacing)));
  return line;
}

/// A run lies along the last axis: along gravity it is one entry, across gravity one for each of its places.
void LineTable::add(const LatticeRun& run) {
  if (axis_ == dim_ - 1) {
    entries_.push_back({line_index(run.column[0], dim_ == 3 ? run.column[1] : -1), run.first, run.last});
    return;
  }
  for (std::int32_t n = run.first; n < run.last; ++n) {
    const std::int32_t along = run.column[axis_];
    entries_.push_back({dim_ == 2 ? line_index(n, -1) : line_index(run.column[1 - axis_], n), along, along + 1});
  }
}

void LineTable::merge() {
  std::size_t kept = 0;
  for (const Entry& e : entries_) {
    if (kept > 0 && entries_[kept - 1].line == e.line && entries_[kept - 1].last == e.first) entries_[kept - 1].last = e.last;
    else entries_[kept++] = e;
  }
  entries_.resize(kept);
}

}  // namespace jaxmpm
