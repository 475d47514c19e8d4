#pragma once
// What a deck comes down to: everything the step needs to know, and the first state. Host side, double precision.
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "deck/deck.hpp"

namespace jaxmpm {

class BodyForce;

using Point = std::array<double, 3>;  // z unused in 2D (zero)

/// Distance and direction of an obstacle's surface: distance < 0 inside the solid; `normal` is a unit vector out of the solid.
struct SignedDistance {
  double distance;
  Point normal;
};

/// A rigid obstacle in lattice coordinates (cells from domain.min), so that nothing depends on the distance from the deck's origin.
struct RigidObstacle {
  std::string name;
  deck::ContactKind kind = deck::ContactKind::separate;
  double coefficient = 0;
  std::function<SignedDistance(const Point&)> signed_distance;            // argument and distance in cells
  std::function<bool(const Point& lower, const Point& upper)> may_touch;  // whether a box of cells can hold points with distance < 1 cell
};

/// Contact law of one domain face; faces are numbered 2·axis + (0: min, 1: max).
struct FaceLaw {
  deck::ContactKind kind = deck::ContactKind::slip;
  std::vector<double> to;           // segment ends along `segment_axis`, in cells, increasing; one per coefficient
  std::vector<double> coefficient;  // friction only; a single one without segments
  int segment_axis = 0;
  Point velocity{};  // of the wall, along itself, m/s
};

/// The particles of one body as they are seeded. Positions in cells from domain.min; ids are unique over the deck and increase with the
/// seed lattice.
struct BodyState {
  std::vector<std::uint32_t> id;
  std::vector<Point> position;                // cells
  std::vector<Point> velocity;                // m/s
  std::vector<double> mass;                   // kg (per metre of thickness in 2D)
  std::vector<double> compression;            // ρ/ρ0 − 1
  std::vector<std::array<double, 6>> stress;  // Pa, xx yy zz xy yz xz; empty when it is none
};

struct Body {
  std::string name;
  deck::Material material;
  BodyState initial;
};

/// Scene and method, ready to run. `cells[d]` whole cells along axis d; node i of axis d lies at domain_min[d] + i·cell_size.
struct Model {
  int dim = 2;
  std::array<int, 3> cells{1, 1, 1};
  Point domain_min{};
  double cell_size = 0;
  Point gravity{};
  std::shared_ptr<const BodyForce> body_force;  // null where the deck has none
  deck::Method method;
  deck::Time time;
  std::array<FaceLaw, 6> faces;
  std::vector<RigidObstacle> obstacles;
  std::vector<Body> bodies;               // in deck order
  bool record_velocity_gradient = false;  // some output asks for it
  bool account_energy = false;            // an energy gauge asks for dissipation
  std::vector<std::string> notices;       // what seeding wants the user to know

  /// Whether there is nothing at the lower or upper face of an axis.
  bool is_open(int axis, bool upper) const { return faces[std::size_t(2 * axis + int(upper))].kind == deck::ContactKind::open; }
  bool has_open_face() const {
    return std::any_of(faces.begin(), faces.end(), [](const FaceLaw& face) { return face.kind == deck::ContactKind::open; });
  }
  bool is_periodic(int axis) const { return faces[std::size_t(2 * axis)].kind == deck::ContactKind::periodic; }
};

/// Closed faces hold what passes them: separate and friction faces let material pass while it presses on the nodes within only, not on those
/// of the face. A particle up to this far beyond one, cells, is set back onto it; one that is farther is part of a run that broke down.
inline constexpr double held_within = 0.5;

/// Builds the model of a deck: seeds bodies, evaluates initial fields, prepares walls and obstacles.
/// Throws DeckError (overlap, empty body, missing height-map values, …) or IoError (files).
Model build_model(const deck::Deck& deck);

}  // namespace jaxmpm
