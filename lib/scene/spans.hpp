#pragma once
// Solid as it is met along one lattice column: sorted, disjoint, half-open intervals [lower, upper), so that solids that share a face never
// share a place.
#include <vector>

namespace jaxmpm {

struct Span {
  double lower, upper;
};
using Spans = std::vector<Span>;

/// Whether a coordinate lies in one of the intervals.
bool contains(const Spans& spans, double coordinate);
/// Sorted and merged union of two lists.
Spans unite(const Spans& a, const Spans& b);
/// What of `a` is not in `b`.
Spans subtract(const Spans& a, const Spans& b);

}  // namespace jaxmpm
