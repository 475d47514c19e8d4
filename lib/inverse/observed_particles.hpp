#pragma once
// Trajectories or velocities of particles, from another run or from CSV.
#include "inverse/observed_rows.hpp"

namespace jaxmpm {

/// Rows of the chosen particles of body number `body`: `subject` is a particle's place in the body, the values are the field's components.
/// From results.h5: every frame, whose particles are those of the deck (same seeding: a particle that starts elsewhere is refused). From
/// CSV: columns time, id, x, y[, z] or vx, vy[, vz], and sigma where there is one. A mask column holds 1 for rows that count and 0 for
/// others; a mask box keeps rows whose observed position lies in it. Throws DeckError, or IoError for an unreadable file.
std::vector<ObservedRow> read_particles(const deck::ParticlesObservation& observed, const ObservationPlace& place, std::size_t body);

}  // namespace jaxmpm
