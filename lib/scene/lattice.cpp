#include "scene/lattice.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace jaxmpm {

std::int64_t Lattice::first_at_or_above(double coordinate) const {
  auto n = static_cast<std::int64_t>(std::floor(coordinate / spacing - 0.5));
  while (place(n - 1) >= coordinate) --n;
  while (place(n) < coordinate) ++n;
  return n;
}

Lattice make_lattice(const deck::Body& body, const Frame& frame, const std::string& pointer) {
  Lattice lattice;
  if (body.spacing) {
    lattice = {*body.spacing / frame.cell_size, 0};
  } else if (body.particles_per_cell) {
    const int k = static_cast<int>(std::lround(std::pow(*body.particles_per_cell, 1.0 / frame.dim)));
    int power = 1;
    for (int d = 0; d < frame.dim; ++d) power *= k;
    if (k < 1 || power != *body.particles_per_cell)
      throw DeckError(pointer + "/particles_per_cell",
                      std::to_string(*body.particles_per_cell) + " particles do not make a lattice in a cell; give k^" +
                          std::to_string(frame.dim) + (frame.dim == 2 ? ": 1, 4, 9, 16 …" : ": 1, 8, 27, 64 …"));
    lattice = {1.0 / k, k};
  }
  const double longest = *std::max_element(frame.cells.begin(), frame.cells.begin() + frame.dim);
  if (longest / lattice.spacing > 1e9)
    throw DeckError(pointer + "/spacing", "the lattice would have more than a billion places along the domain; give a larger spacing");
  return lattice;
}

}  // namespace jaxmpm
