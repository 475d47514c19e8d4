#pragma once
// What a scene could do without, or should not do: advice from the measurements of docs/stability.md, docs/charts.md and
// docs/validation.md.
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// Steps that a run would take: the first one, and the limit of the first state (a wave's way through a cell), s.
struct FirstStep {
  double dt, limit;
};

/// One sentence each, with the figure it rests on and where that is from. Never an error: the deck stays as it is.
std::vector<std::string> advice(const deck::Deck& deck, const Model& model, const FirstStep& step);

}  // namespace jaxmpm
