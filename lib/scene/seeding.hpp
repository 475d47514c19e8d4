#pragma once
// Where a deck's bodies have particles: the lattice places inside each shape and outside every obstacle.
#include <optional>
#include <vector>

#include "scene/lattice.hpp"
#include "scene/points.hpp"

namespace jaxmpm {

/// The lattice of one body and its places in the order of their ids: first axis slowest, last axis fastest. Or the points that a file has
/// for it: then there is no lattice.
struct Seeds {
  std::optional<PlacedPoints> points;
  Lattice lattice;
  std::vector<LatticeRun> runs;
  std::uint64_t count = 0;  // of places
  std::uint64_t cut = 0;    // places of the shape that lie inside an obstacle, and are left out

  /// Volume of particle p, m³ (in 2D m²).
  double volume(std::size_t p, const Frame& frame) const;
};

struct SeededScene {
  std::vector<GeometryPointer> shapes;  // of the bodies
  std::vector<Seeds> seeds;
};

/// Shapes of the deck's obstacles.
std::vector<GeometryPointer> obstacle_shapes(const deck::Deck& deck, const Frame& frame);

/// Seeds every body. `obstacles` are the obstacles' shapes. DeckError at /bodies/i for a body without particles, one that leaves the
/// domain, or one that holds a particle of another.
SeededScene seed_bodies(const deck::Deck& deck, const Frame& frame, const std::vector<GeometryPointer>& obstacles);

/// Positions (cells) of a body's particles, jittered where the deck asks for it. A displaced particle that would leave its shape or enter
/// an obstacle stays on the lattice. The displacement depends on the seed and the id (`first_id` is that of the first particle) alone.
std::vector<Point> seed_positions(const deck::Body& body, const Frame& frame, const Geometry& shape, const Seeds& seeds,
                                  const std::vector<GeometryPointer>& obstacles, std::uint32_t first_id);

}  // namespace jaxmpm
