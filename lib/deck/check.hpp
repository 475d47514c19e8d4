#pragma once
// Checks that look at several parts of a deck at once: references, names, and what has no effect in this scene.
#include "core/describe_place.hpp"
#include "deck/inverse.hpp"

namespace jaxmpm::deck {

/// Whether gravity has one component other than zero.
bool along_an_axis(const Numbers& gravity);

/// Reports to `root.reader`. Parts that could not be read are passed over.
void check_scene(const Deck& deck, const described::Place& root);
void check_gauges(const Deck& deck, const described::Place& root);
void check_inverse(const Deck& deck, const described::Place& root);
/// One of /inverse/observations, at `place`: what it names, whether it can be differentiated, times outside of the run, keys without
/// effect.
void check_observation(const Deck& deck, const Observation& observation, const described::Place& place);

/// Names of a list of named structs (bodies, obstacles).
template <class T>
std::vector<std::string> names_in(const std::vector<T>& list) {
  std::vector<std::string> names;
  for (const T& item : list) names.push_back(item.name);
  return names;
}
template <class T>
std::vector<std::string> names_in(const std::map<std::string, T>& map) {
  std::vector<std::string> names;
  for (const auto& [name, value] : map) names.push_back(name);
  return names;
}
/// Reports unless `name` is one of `names`; `what` is the kind of thing it should name.
void check_reference(const std::string& name, const std::vector<std::string>& names, const std::string& what,
                     const described::Place& place);

}  // namespace jaxmpm::deck
