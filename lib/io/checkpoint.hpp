#pragma once
// DIR/checkpoint.h5: all that a run needs to go on as if it had never stopped.
#include <optional>
#include <string>

#include "io/index.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

struct Checkpoint {
  Moment at;
  double seconds = 0;  // wall time in steps so far
  std::string deck;    // resolved
  std::string backend;
  std::vector<FrameEntry> frames;
  std::map<std::string, GaugeSeries> gauges;
  SavedState state;
};

/// Throws NumericsError when a state is not finite: it must not become a checkpoint.
void require_finite(const Moment& at, const std::vector<RawArray>& state);
/// Throws IoError when it cannot be written.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);
/// Throws IoError when the file is missing, damaged or no checkpoint of this format.
Checkpoint read_checkpoint(const std::string& path);

/// The newest readable checkpoint of a directory, with a warning for a damaged one; empty when there is none at all.
/// Throws IoError when there are some but none can be read.
std::optional<Checkpoint> newest_checkpoint(const ResultsDirectory& directory);

/// Throws DeckError naming every key in which the deck differs from that of a checkpoint or of earlier results, but for those at or below
/// the pointers `may_change`.
void require_same_deck(const std::string& before, const std::string& now, const std::string& file,
                       const std::vector<std::string>& may_change = {"/time/end", "/output"});

}  // namespace jaxmpm
