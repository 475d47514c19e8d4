#include "scene/initial_stress.hpp"

#include "scene/initial_weight.hpp"

namespace jaxmpm {

using Kind = deck::InitialStress::Kind;

bool columns_needed(const deck::Deck& deck) {
  return std::any_of(deck.bodies.begin(), deck.bodies.end(),
                     [](const deck::Body& body) { return body.initial_stress.kind != Kind::none && !body.initial_stress.surface; });
}

void check_gravity(const deck::InitialStress& stress, double size, int axis, std::size_t body) {
  if (size == 0) throw DeckError(stress_pointer(body), "without gravity there is no weight to bear; use \"none\"");
  if (axis < 0 && !stress.surface)
    throw DeckError(stress_pointer(body),
                    "gravity is along no axis, so that no column tells the depth; give \"surface\": { \"point\": […] }, a point of "
                    "the free surface (the plane through it across gravity)");
}

std::vector<double> set_initial_stress(const deck::Deck& deck, const Frame& frame, const std::vector<Seeds>& seeds,
                                       std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (deck.bodies[i].initial_stress.kind != Kind::none) bodies[i].initial.stress.resize(bodies[i].initial.position.size());
  return spread_weight({deck, frame, seeds, bodies}, DeckNumber{},
                       [&](std::size_t i, std::size_t p, double compression, const std::array<double, 6>& stress) {
                         bodies[i].initial.compression[p] = compression;
                         bodies[i].initial.stress[p] = stress;
                       });
}

}  // namespace jaxmpm
