#include <algorithm>
#include <regex>

#include "deck/check.hpp"
#include "deck/descriptions.hpp"
#include "deck/inverse.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Json;
using described::Place;

namespace {

/// Numbers that enter the step or the initial fields at fixed seeding, by the pattern of their pointer.
bool may_be_unknown(const std::string& pointer) {
  static const std::regex pattern(
      "/gravity/[0-9]+|/method/flip_fraction|/parameters/[^/]+|/materials/[^/]+/[^/]+|/bodies/[0-9]+/velocity/[0-9]+(/mlp)?|"
      "/bodies/[0-9]+/initial_stress/k0|/walls/[^/]+/(coefficient|segments/[0-9]+/coefficient)|/obstacles/[0-9]+/coefficient");
  return std::regex_match(pointer, pattern);
}

/// All pointers that a path with * stands for.
std::vector<std::string> expand(const Json& value, const std::string& path, const std::string& pointer = {}) {
  if (path.empty()) return {pointer};
  const std::size_t next = std::min(path.find('/', 1), path.size());
  const std::string part = path.substr(1, next - 1), rest = path.substr(next);
  std::vector<std::string> found;
  for (const auto& [key, child] : value.items()) {
    const std::string below = join(pointer, key);
    if (!value.is_structured() || (part != "*" && join("", key) != "/" + part)) continue;
    for (std::string& one : expand(child, rest, below)) found.push_back(std::move(one));
  }
  return found;
}

void check_target(const Json& deck, const std::string& pointer, const Place& path) {
  const Json& value = deck.at(Json::json_pointer(pointer));
  const bool network = pointer.size() > 4 && pointer.compare(pointer.size() - 4, 4, "/mlp") == 0;
  if (!may_be_unknown(pointer))
    path.problem(pointer +
                 " cannot be an unknown: it is fixed before the first step (seeding, grid, times, output); choose a number of the step or "
                 "of the initial fields");
  else if (!value.is_number() && !network)
    path.problem(pointer + " is " + described::shown(value) + ", not a number; give it one, or choose another");
}

void check_unknown(const Json& deck, const Unknown& unknown, const Place& place) {
  const std::vector<std::string> pointers = expand(deck, unknown.path);
  if (pointers.empty()) return place.problem("path", "there is no " + unknown.path + " in the deck; correct the pointer");
  for (const std::string& pointer : pointers) check_target(deck, pointer, place.key("path"));
  const auto* starts = std::get_if<Numbers>(&unknown.start);
  if (starts != nullptr && starts->size() != pointers.size())
    place.problem("start", "must have one number for each of the " + std::to_string(pointers.size()) + " pointers, found " +
                               std::to_string(starts->size()));
  if (unknown.share && pointers.size() == 1) place.problem("share", "has no effect on a single number; remove it");
}

void check_observation(const Deck& deck, const Observation& observation, const Place& place) {
  if (const auto* particles = std::get_if<ParticlesObservation>(&observation))
    check_reference(particles->body, names_in(deck.bodies), "body", place.key("body"));
  if (const auto* profile = std::get_if<ProfileObservation>(&observation))
    check_reference(profile->body, names_in(deck.bodies), "body", place.key("body"));
  const auto* observed = std::get_if<GaugeObservation>(&observation);
  if (observed == nullptr) return;
  check_reference(observed->gauge, names_in(deck.gauges), "gauge", place.key("gauge"));
  const auto gauge = deck.gauges.find(observed->gauge);
  if (gauge == deck.gauges.end()) return;
  if (const auto* front = std::get_if<FrontGauge>(&gauge->second); front != nullptr && front->smooth == 0.0)
    place.problem("gauge", "\"" + observed->gauge + "\" has smooth 0: a hard gauge has no derivative; give it a width");
}

}  // namespace

void check_inverse(const Deck& deck, const Place& root) {
  if (deck.inverse.empty() || !root.reader.problems().empty()) return;
  Inverse inverse;
  const Place place = root.key("inverse");
  described::Codec<Inverse>::read(inverse, place, {});
  const Json written = described::Codec<Deck>::write(deck, {});
  for (std::size_t i = 0; i < inverse.unknowns.size(); ++i) check_unknown(written, inverse.unknowns[i], place.key("unknowns").item(i));
  for (std::size_t i = 0; i < inverse.observations.size(); ++i)
    check_observation(deck, inverse.observations[i], place.key("observations").item(i));
}

}  // namespace jaxmpm::deck
