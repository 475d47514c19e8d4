#pragma once
// Stress and density at the start from the weight above (deck key initial_stress).
#include <vector>

#include "scene/seeding.hpp"

namespace jaxmpm {

/// Sets stress and compression of every body that asks for one, from positions that are already there.
///
/// With vertical pressure s, lateral pressure k s (k = 1: hydrostatic; K0: geostatic) and mean pressure (1 + 2k)/3 · s = m s, the linear
/// law m s = K e (newtonian: K = ρ0 c², exactly p = c²(ρ − ρ0); solids: to first order in s/K) gives the density ρ0 (1 + e), and
/// equilibrium ds/dδ = ρ g along depth δ
///   s(δ) = (s0 + K/m) exp(ρ0 g m δ / K) − K/m,
/// which for one fluid is p = ρ0 c² (exp(g δ/c²) − 1). Bodies without initial stress weigh ρ0. Depth starts at the upper face of the
/// highest lattice cell of all bodies on the line along gravity; a gap below it counts as filled by what lies beneath it (an obstacle in a
/// pool does not part its water). DeckError at /bodies/i/initial_stress without gravity, without a line to follow, or for a fluid with an
/// earth pressure coefficient. Returns for each body the largest gap that was counted as filled, cells.
std::vector<double> set_initial_stress(const deck::Deck& deck, const Frame& frame, const std::vector<Seeds>& seeds,
                                       std::vector<Body>& bodies);

}  // namespace jaxmpm
