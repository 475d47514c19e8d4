#pragma once
// Clusters of occupied cells: what of a body still hangs together.
#include <vector>

#include "solvers/solver.hpp"

namespace jaxmpm {

/// For each particle of a body whether its cell belongs to the cluster of cells with the most mass. Cells that share a face, an edge or a
/// corner belong together; of equal clusters the one with the first cell (z slowest) counts.
std::vector<bool> in_largest_cluster(const BodySnapshot& body, const Model& model);

}  // namespace jaxmpm
