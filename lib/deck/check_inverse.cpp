#include <algorithm>
#include <map>
#include <regex>

#include "deck/check.hpp"
#include "deck/describe_inverse.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Json;
using described::Place;

namespace {

/// Numbers that enter the step or the initial fields at fixed seeding, by the pattern of their pointer.
bool may_be_unknown(const std::string& pointer) {
  static const std::regex pattern(
      "/gravity/[0-9]+|/body_force/[0-9]+|/method/(flip_fraction|damping)|/parameters/[^/]+|/materials/[^/]+/[^/]+|/bodies/[0-9]+/velocity/"
      "([0-9]+(/mlp)?|particles)|"
      "/bodies/[0-9]+/initial_stress/k0|/walls/[^/]+/(coefficient|segments/[0-9]+/coefficient)|"
      "/walls/(x_[^/]+/velocity/[12]|y_[^/]+/velocity/[02]|z_[^/]+/velocity/[01])|/obstacles/[0-9]+/coefficient");
  return std::regex_match(pointer, pattern);
}

std::vector<std::string> expand(const Json& value, const std::string& path, const std::string& pointer) {
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
  if (!may_be_unknown(pointer))
    path.problem(pointer +
                 " cannot be an unknown: it is fixed before the first step (seeding, grid, times, output); choose a number of the step or "
                 "of the initial fields");
  else if (!value.is_number() && !is_list(pointer))
    path.problem(pointer + " is " + described::shown(value) + ", not a number; give it one, or choose another");
}

/// A network's weights start from its seed and have no meaning one by one; velocities of particles start from their file.
void check_list(const Unknown& unknown, const std::vector<std::string>& pointers, const Place& place) {
  const bool network = std::any_of(pointers.begin(), pointers.end(), is_network);
  if (!network && std::none_of(pointers.begin(), pointers.end(), is_particle_velocities)) return;
  if (!std::holds_alternative<std::monostate>(unknown.start))
    place.problem("start", network ? "has no effect on a network, whose weights start from its seed (or its key weights); remove it"
                                   : "has no effect on velocities of particles, which start from those of their file; remove it");
  if (network && unknown.transform != Transform::none)
    place.problem("transform", "makes no sense for a network, whose weights may have either sign; remove it");
  if (unknown.share)
    place.problem("share", network ? "is for numbers; networks have weights of their own: remove it"
                                   : "is for numbers; particles have velocities of their own: remove it");
}

/// Where the optimiser begins when the unknown gives no start: the deck's own values.
void check_own_values(const Json& deck, const Unknown& unknown, const std::vector<std::string>& pointers, const Place& place) {
  if (!std::holds_alternative<std::monostate>(unknown.start)) return;
  for (const std::string& pointer : pointers) {
    const Json& value = deck.at(Json::json_pointer(pointer));
    if (!value.is_number()) continue;
    check_start_value(unknown, value.get<double>(), "the deck's " + pointer + ", where the search would start: ", place);
    if (unknown.share && value != deck.at(Json::json_pointer(pointers[0])))
      place.problem("start", "is needed: the deck's values of what shares one differ, " + pointers[0] + " and " + pointer);
  }
}

void check_unknown(const Json& deck, const Unknown& unknown, const Place& place) {
  const std::vector<std::string> pointers = expand(deck, unknown.path, {});
  if (pointers.empty()) return place.problem("path", "there is no " + unknown.path + " in the deck; correct the pointer");
  for (const std::string& pointer : pointers) check_target(deck, pointer, place.key("path"));
  const auto* starts = std::get_if<Numbers>(&unknown.start);
  if (starts != nullptr && unknown.share) place.problem("start", "must be one number where one value is shared");
  else if (starts != nullptr && starts->size() != pointers.size())
    place.problem("start", "must have one number for each of the " + std::to_string(pointers.size()) + " pointers, found " +
                               std::to_string(starts->size()));
  if (unknown.share && pointers.size() == 1) place.problem("share", "has no effect on a single number; remove it");
  check_list(unknown, pointers, place);
  check_own_values(deck, unknown, pointers, place);
}

/// A number that two unknowns name would have two values.
void check_twice(const Json& deck, const std::vector<Unknown>& unknowns, const Place& place) {
  std::map<std::string, std::size_t> owner;
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    for (const std::string& pointer : expand(deck, unknowns[i].path, {}))
      if (const auto [before, is_new] = owner.emplace(pointer, i); !is_new)
        place.item(i).problem("path",
                              pointer + " is an unknown already, by " + place.item(before->second).pointer + "; remove one of them");
}

/// A gradient follows every particle through every step.
void check_all_are_followed(const Deck& deck, const Place& root) {
  if (deck.method.rest) root.reader.problem("/method/rest", "leaves particles out of steps, and a gradient follows every one; remove it");
  for (const auto& [face, wall] : deck.walls)
    if (wall.kind == ContactKind::open)
      root.reader.problem(join(join("/walls", face), "kind"),
                          "lets particles go, and a gradient follows every one; close the face, or make the domain longer");
}

}  // namespace

bool is_network(const std::string& pointer) {
  static const std::regex pattern("/bodies/[0-9]+/velocity/[0-9]+/mlp");
  return std::regex_match(pointer, pattern);
}

bool is_particle_velocities(const std::string& pointer) {
  static const std::regex pattern("/bodies/[0-9]+/velocity/particles");
  return std::regex_match(pointer, pattern);
}

std::vector<std::string> pointers_of(const std::string& path, const Json& resolved) { return expand(resolved, path, {}); }

Inverse inverse_of(const Deck& deck) {
  if (deck.inverse.empty())
    throw DeckError("/inverse", "is missing: it names the unknowns and the observations that are to find them (docs/calibration.md)");
  Inverse inverse;
  const Json text = Json::parse(deck.inverse);
  described::Reader reader([](const std::string&) { return 0; }, deck.dimension());
  described::Codec<Inverse>::read(inverse, {text, "/inverse", reader}, {});
  return inverse;
}

void check_inverse(const Deck& deck, const Place& root) {
  if (deck.inverse.empty() || !root.reader.problems().empty()) return;
  check_all_are_followed(deck, root);
  Inverse inverse;
  const Place place = root.key("inverse");
  described::Codec<Inverse>::read(inverse, place, {});
  const Json written = described::Codec<Deck>::write(deck, {});
  for (std::size_t i = 0; i < inverse.unknowns.size(); ++i) check_unknown(written, inverse.unknowns[i], place.key("unknowns").item(i));
  check_twice(written, inverse.unknowns, place.key("unknowns"));
  for (std::size_t i = 0; i < inverse.observations.size(); ++i)
    check_observation(deck, inverse.observations[i], place.key("observations").item(i));
}

}  // namespace jaxmpm::deck
