#pragma once
// How /inverse is read, checked and written; apart from its structs, as the users of those need no JSON.
#include <string>
#include <vector>

#include "deck/descriptions.hpp"
#include "deck/inverse.hpp"

namespace jaxmpm::deck {

/// Reports a value outside of an unknown's bounds or of what its transform can take; `what` comes before the value in the message.
void check_start_value(const Unknown& unknown, double value, const std::string& what, const described::Place& place);
/// JSON pointers that a path with * stands for in a resolved deck, in the deck's order.
std::vector<std::string> pointers_of(const std::string& path, const described::Json& resolved);

described::EnumNames<Transform> names_of(Transform);
described::EnumNames<ProfileReading> names_of(ProfileReading);
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
