#include "deck/check.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Place;

namespace {

/// A place that a gauge reads; `axes`: which coordinates it has.
void check_within(const Deck& deck, const Numbers& at, const std::vector<std::size_t>& axes, const Place& place) {
  for (std::size_t k = 0; k < at.size() && k < axes.size(); ++k) {
    const double low = deck.domain.min[axes[k]], high = deck.domain.max[axes[k]];
    if (at[k] < low || at[k] > high)
      place.item(k).problem("lies outside of the domain along " + std::string(1, "xyz"[axes[k]]) + ", " + described::shown_number(low) +
                            " to " + described::shown_number(high) + ": nothing would ever be read there");
  }
}

void check_places(const Deck& deck, const Place& root) {
  if (root.reader.troubled("/domain") || root.reader.troubled("/gravity")) return;
  const std::size_t dim = deck.domain.min.size();
  std::vector<std::size_t> all, plan;
  for (std::size_t d = 0; d < dim; ++d) {
    all.push_back(d);
    if (d != up_axis(deck.gravity)) plan.push_back(d);
  }
  for (const auto& [name, gauge] : deck.gauges) {
    const Place place = root.key("gauges").key(name);
    if (const auto* height = std::get_if<HeightGauge>(&gauge); height && place.sound({"kind", "at"}))
      check_within(deck, height->at, plan, place.key("at"));
    if (const auto* pressure = std::get_if<PressureGauge>(&gauge); pressure && place.sound({"kind", "at"}))
      check_within(deck, pressure->at, all, place.key("at"));
    const auto* mean = std::get_if<RegionMeanGauge>(&gauge);
    if (!mean || !place.sound({"kind", "min", "max"})) continue;
    for (std::size_t d = 0; d < dim && d < mean->min.size() && d < mean->max.size(); ++d)
      if (mean->min[d] >= deck.domain.max[d] || mean->max[d] <= deck.domain.min[d])
        place.key("min").item(d).problem("the region lies outside of the domain along " + std::string(1, "xyz"[d]) +
                                         ": nothing would ever be read there");
  }
}

/// Depth is measured along the vertical, of what lies across the front's way.
void check_depth(const Deck& deck, const FrontGauge& front, const Place& place) {
  if (!front.depth || deck.gravity.empty() || !place.sound({"kind", "axis"})) return;
  if (front.axis == std::string(1, "xyz"[up_axis(deck.gravity)]))
    place.problem("depth",
                  "is measured along " + front.axis +
                      ", the vertical, and cannot tell how far the material reaches along it; leave it out, or choose another axis");
}

bool is_open(const Deck& deck, const std::string& face) {
  const auto wall = deck.walls.find(face);
  return wall != deck.walls.end() && wall->second.kind == ContactKind::open;
}

}  // namespace

void check_gauges(const Deck& deck, const Place& root) {
  const auto refer = [&root](const std::string& gauge, const std::string& key, const std::string& name,
                             const std::vector<std::string>& names) {
    const Place place = root.key("gauges").key(gauge);
    if (place.given(key) && place.sound({"kind", key})) check_reference(name, names, key, place.key(key));
  };
  for (const auto& [name, gauge] : deck.gauges) {
    if (const auto* front = std::get_if<FrontGauge>(&gauge)) {
      refer(name, "body", front->body, names_in(deck.bodies));
      check_depth(deck, *front, root.key("gauges").key(name));
    }
    if (const auto* force = std::get_if<ForceGauge>(&gauge)) {
      refer(name, "obstacle", force->obstacle, names_in(deck.obstacles));
      if (is_open(deck, force->wall))
        root.key("gauges").key(name).problem("wall", "is an open face: nothing is there that could be pushed");
    }
    if (std::holds_alternative<ParticlesGauge>(gauge))
      for (const auto& [face, wall] : deck.walls)
        if (wall.kind == ContactKind::open)
          root.key("gauges").key(name).problem("kind", "follows particles, which may leave through the open face " + face +
                                                           "; take a region_mean, or read them from the frames");
  }
  check_places(deck, root);
  if (root.given("output") && root.key("output").given("gauge_interval") && !root.given("gauges"))
    root.key("output").problem("gauge_interval", "has no effect without gauges; remove it");
}

}  // namespace jaxmpm::deck
