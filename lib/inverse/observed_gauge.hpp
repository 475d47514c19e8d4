#pragma once
// Series of gauges and profiles of deposits, from another run or from CSV.
#include "inverse/observed_rows.hpp"
#include "observe/gauge.hpp"

namespace jaxmpm {

/// Rows of a gauge of the deck. From results.h5: the valid readings of the gauge of that name. From CSV: columns time and value, or
/// value_COMPONENT for each component of a vector or tensor, and sigma where there is one. Throws DeckError, or IoError for an unreadable
/// file.
std::vector<ObservedRow> read_gauge(const deck::GaugeObservation& observed, const ObservationPlace& place, const Gauge& gauge);

/// Heights of a deposit: horizontal coordinates (m) of each place, and rows whose `subject` is a place.
struct ObservedProfile {
  std::vector<deck::Numbers> at;
  std::vector<ObservedRow> rows;  // all at the same time
};

/// The profile of body number `body` at the observation's time. From CSV: a column for each horizontal coordinate (x[, y]), height (the
/// surface's coordinate along the axis that is up, m), sigma where there is one. From results.h5: the height over the middle of each cell
/// of this deck, of the body's particles in the frame at that time; the frames need the density, and a particle's volume is that of its
/// seed lattice times ρ(start)/ρ. Throws DeckError, or IoError for an unreadable file.
ObservedProfile read_profile(const deck::ProfileObservation& observed, const ObservationPlace& place, std::size_t body);

}  // namespace jaxmpm
