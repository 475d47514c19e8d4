#pragma once
// Velocities at the start (deck key velocity).
#include "scene/frame.hpp"

namespace jaxmpm {

/// Sets the velocity (m/s) of every particle of body `index` from numbers, expressions, networks or a file, by ids and positions that are
/// already there. A file is a table with columns id, vx, vy (and vz in 3D); it names every particle of the body, and may name those of
/// others; a column `time` must hold one time only. DeckError (contents, a value that is not finite) or IoError (unreadable file).
void set_initial_velocity(const deck::Deck& deck, const Frame& frame, std::size_t index, BodyState& state);

}  // namespace jaxmpm
