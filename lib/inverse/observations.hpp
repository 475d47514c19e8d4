#pragma once
// The observations of a deck as the Observer of a differentiated run.
#include <memory>

#include "inverse/observer.hpp"

namespace jaxmpm {

/// Observer of all observations of the deck's /inverse, which it must have. Its loss is the masked least squares of Du & He 2025, Eq 28,
/// halved, with weights and standard deviations:
///   L = ½ Σ_o w_o Σ_t Σ_l ‖(Q_l(z^t) − z_obs,l,t) / σ_l,t‖² = ½ ‖r‖²,
/// a plain sum (no mean) over observations o (weight w_o), their times t and subjects l (particles, a gauge, columns of a profile), which
/// are those that masks, windows and selections leave; σ = 1 unless a CSV has a column sigma. A residual is √w_o (Q − z_obs)/σ; they are in
/// the order of observations, times, subjects, components. Where a gauge has no material to read, its residual is 0 and a warning says how
/// often; the height of a deposit is the ground there. Sums are taken in that order, so that the bits do not depend on the number of
/// threads.
///
/// Throws DeckError where an observation and the deck or the file do not fit (with pointer, file, line and remedy), IoError for a file that
/// cannot be read.
std::unique_ptr<Observer> make_observer(const deck::Deck& deck, const Model& model);

}  // namespace jaxmpm
