#include "deck/check.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Place;

void check_gauges(const Deck& deck, const Place& root) {
  for (const auto& [name, gauge] : deck.gauges) {
    if (root.reader.troubled(join("/gauges", name))) continue;
    const Place place = root.key("gauges").key(name);
    if (const auto* front = std::get_if<FrontGauge>(&gauge)) check_reference(front->body, names_in(deck.bodies), "body", place.key("body"));
    const auto* force = std::get_if<ForceGauge>(&gauge);
    if (force != nullptr && !force->obstacle.empty())
      check_reference(force->obstacle, names_in(deck.obstacles), "obstacle", place.key("obstacle"));
  }
  if (root.given("output") && root.key("output").given("gauge_interval") && !root.given("gauges"))
    root.key("output").problem("gauge_interval", "has no effect without gauges; remove it");
}

}  // namespace jaxmpm::deck
