#include "deck/check.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Place;

void check_gauges(const Deck& deck, const Place& root) {
  const auto refer = [&root](const std::string& gauge, const std::string& key, const std::string& name,
                             const std::vector<std::string>& names) {
    const Place place = root.key("gauges").key(gauge);
    if (place.given(key) && place.sound({"kind", key})) check_reference(name, names, key, place.key(key));
  };
  for (const auto& [name, gauge] : deck.gauges) {
    if (const auto* front = std::get_if<FrontGauge>(&gauge)) refer(name, "body", front->body, names_in(deck.bodies));
    if (const auto* force = std::get_if<ForceGauge>(&gauge)) refer(name, "obstacle", force->obstacle, names_in(deck.obstacles));
  }
  if (root.given("output") && root.key("output").given("gauge_interval") && !root.given("gauges"))
    root.key("output").problem("gauge_interval", "has no effect without gauges; remove it");
}

}  // namespace jaxmpm::deck
