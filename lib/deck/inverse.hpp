#pragma once
// The deck's /inverse: unknowns, observations and optimiser. Part of the deck's format, used by invert and gradient alone.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "deck/deck.hpp"

namespace jaxmpm::deck {

enum class Transform { none, log, logit };
struct Prior {
  std::optional<double> mean; /* empty: where the search starts */
  double deviation = 0;
};
using Start = std::variant<std::monostate, double, Numbers>;  // nothing: the deck's value
struct Unknown {
  std::string path;
  Start start;
  std::optional<Numbers> bounds;
  Transform transform = Transform::none;
  bool share = false;
  std::optional<Prior> prior;
};

struct RandomSelection {
  std::int64_t random = 0;
  std::uint64_t seed = 1;
};
struct IdSelection {
  std::vector<std::int64_t> ids;
};
using Selection = std::variant<std::monostate, RandomSelection, IdSelection>;  // nothing: "all"
struct Noise {
  double deviation = 0;
  std::uint64_t seed = 1;
};
using Mask = std::variant<std::monostate, std::string, Box>;  // nothing: "none"; a column of the CSV; a box
/// What all kinds of observation share.
struct Observed {
  std::string file;
  std::optional<double> from_time, to_time, every, average;
  double weight = 1;
  std::optional<Noise> noise;
  Mask mask;
};
struct ParticlesObservation : Observed {
  std::string body, field;
  Selection select;
};
struct GaugeObservation : Observed {
  std::string gauge;
};
enum class ProfileReading { surface, depth };
struct ProfileObservation : Observed {
  std::string body;
  ProfileReading reading = ProfileReading::surface;
  std::optional<double> time; /* empty: the end */
};
using Observation = std::variant<ParticlesObservation, GaugeObservation, ProfileObservation>;

struct Adam {
  double learning_rate = 0.1, decay = 0.98;
  int iterations = 150;
  std::optional<double> tolerance;
};
struct Lbfgs {
  int iterations = 100, memory = 10;
  std::optional<double> tolerance;
};
struct GaussNewton {
  double spacing = 0.05;
  int iterations = 20;
  std::optional<double> tolerance;
};
using Optimizer = std::variant<Adam, Lbfgs, GaussNewton>;

struct Inverse {
  std::vector<Unknown> unknowns;
  std::vector<Observation> observations;
  Optimizer optimizer;
  std::string memory = "4 GiB", disk = "none";
};

/// The deck's /inverse, which reading the deck has checked. Throws DeckError when it has none.
Inverse inverse_of(const Deck& deck);
/// Whether a pointer is that of a network, whose value is all its weights.
bool is_network(const std::string& pointer);
/// Whether a pointer is that of velocities from a file, whose value is those of all particles of the body.
bool is_particle_velocities(const std::string& pointer);
/// Whether the value at a pointer is many numbers, which are one unknown.
inline bool is_list(const std::string& pointer) { return is_network(pointer) || is_particle_velocities(pointer); }

}  // namespace jaxmpm::deck
