#include <algorithm>

#include "deck/check.hpp"

namespace jaxmpm::deck {

using described::Place;
using described::shown_number;

namespace {

/// Why readings of a gauge cannot be differentiated by the particles; empty where they can.
struct Underivable {
  std::string operator()(const FrontGauge& g) const {
    return g.smooth == 0.0 ? "has smooth 0: a hard front has no derivative; give it a width" : "";
  }
  std::string operator()(const RegionMeanGauge& g) const {
    return g.field == "velocity_gradient" ? "reads the velocity gradient, which is the grid's and has no derivative; choose another field"
                                          : "";
  }
  std::string operator()(const ParticlesGauge& g) const {
    const bool has_none = std::count(g.fields.begin(), g.fields.end(), "velocity_gradient") > 0;
    return has_none ? "reads the velocity gradient, which is the grid's and has no derivative; leave that field out" : "";
  }
  std::string operator()(const ForceGauge&) const {
    return "is a force, which belongs to a step and not to a state, and has no derivative; observe a pressure, or the momentum";
  }
  std::string operator()(const EnergyGauge&) const {
    return "is an energy balance, which holds sums over all steps and has no derivative; observe a region mean, or the momentum";
  }
  template <class Kind>
  std::string operator()(const Kind&) const {
    return {};
  }
};

void check_gauge(const Deck& deck, const GaugeObservation& observed, const Place& place) {
  check_reference(observed.gauge, names_in(deck.gauges), "gauge", place.key("gauge"));
  const auto gauge = deck.gauges.find(observed.gauge);
  if (gauge == deck.gauges.end()) return;
  if (const std::string reason = std::visit(Underivable{}, gauge->second); !reason.empty())
    place.problem("gauge", "\"" + observed.gauge + "\" " + reason);
  if (std::holds_alternative<Box>(observed.mask))
    place.problem("mask", "a gauge's readings are at no place: a box has no effect; name a CSV column, or leave it out");
}

void check_profile(const ProfileObservation& observed, const Place& place) {
  if (observed.from_time) place.problem("from_time", "has no effect on a profile, which is at one time; give that as `time`");
  if (observed.to_time) place.problem("to_time", "has no effect on a profile, which is at one time; give that as `time`");
  if (observed.every) place.problem("every", "has no effect on a profile, which is at one time; remove it");
  if (observed.average) place.problem("average", "has no effect on a profile, which is at one time; remove it");
}

void check_time(const std::optional<double>& time, const std::string& key, double end, const Place& place) {
  if (time && *time > end)
    place.problem(key,
                  shown_number(*time) + " s is after the end of the run, " + shown_number(end) + " s (/time/end); choose an earlier one");
}

}  // namespace

void check_observation(const Deck& deck, const Observation& observation, const Place& place) {
  const double end = deck.time.end;
  std::visit(
      [&](const auto& observed) {
        check_time(observed.from_time, "from_time", end, place);
        check_time(observed.to_time, "to_time", end, place);
      },
      observation);
  if (const auto* particles = std::get_if<ParticlesObservation>(&observation))
    check_reference(particles->body, names_in(deck.bodies), "body", place.key("body"));
  if (const auto* gauge = std::get_if<GaugeObservation>(&observation)) check_gauge(deck, *gauge, place);
  const auto* profile = std::get_if<ProfileObservation>(&observation);
  if (profile == nullptr) return;
  check_reference(profile->body, names_in(deck.bodies), "body", place.key("body"));
  check_profile(*profile, place);
  check_time(profile->time, "time", end, place);
}

}  // namespace jaxmpm::deck
