#pragma once
// The deck's /inverse: unknowns, observations and optimiser. Part of the deck's format, used by invert and gradient alone.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "deck/descriptions.hpp"

namespace jaxmpm::deck {

enum class Transform { none, log, logit };
struct Prior {
  double mean = 0, deviation = 0;
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
struct ProfileObservation : Observed {
  std::string body;
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
  int iterations = 20;
  std::optional<double> tolerance;
};
using Optimizer = std::variant<Adam, Lbfgs, GaussNewton>;

struct Inverse {
  std::vector<Unknown> unknowns;
  std::vector<Observation> observations;
  Optimizer optimizer;
  std::string memory = "4 GiB";
};

/// The deck's /inverse, which reading the deck has checked. Throws DeckError when it has none.
Inverse inverse_of(const Deck& deck);
/// Reports a value outside of an unknown's bounds or of what its transform can take; `what` comes before the value in the message.
void check_start_value(const Unknown& unknown, double value, const std::string& what, const described::Place& place);
/// JSON pointers that a path with * stands for in a resolved deck, in the deck's order.
std::vector<std::string> pointers_of(const std::string& path, const described::Json& resolved);
/// Whether a pointer is that of a network, whose value is all its weights.
bool is_network(const std::string& pointer);

described::EnumNames<Transform> names_of(Transform);
void describe(Description<Prior>& d);
void describe(Description<Unknown>& d);
void describe(Description<RandomSelection>& d);
void describe(Description<IdSelection>& d);
void describe(Description<Noise>& d);
void describe(Description<ParticlesObservation>& d);
void describe(Description<GaugeObservation>& d);
void describe(Description<ProfileObservation>& d);
void describe(Description<Adam>& d);
void describe(Description<Lbfgs>& d);
void describe(Description<GaussNewton>& d);
void describe(Description<Inverse>& d);

}  // namespace jaxmpm::deck

namespace jaxmpm::described {
JAXMPM_CODEC(deck::Start);
JAXMPM_CODEC(deck::Selection);
JAXMPM_CODEC(deck::Mask);
JAXMPM_CODEC(deck::Observation);
JAXMPM_CODEC(deck::Optimizer);
}  // namespace jaxmpm::described

namespace jaxmpm::deck {

/// Codec of Deck::inverse: reads and checks an Inverse, keeps its JSON text with every default filled in.
struct InverseText {
  static void read(std::string& out, const described::Place& place, const described::Limits& limits);
  static described::Json write(const std::string& in, const described::Limits& limits);
  static described::Json schema(const described::Limits& limits, described::Schema& defs);
};

}  // namespace jaxmpm::deck
