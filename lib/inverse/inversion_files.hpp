#pragma once
// DIR/inversion.json, DIR/inversion.h5 and DIR/velocity_BODY.csv (docs/results.md): what an inversion has found so far, and all that it
// needs to go on.
#include <optional>
#include <string>

#include "inverse/recorded_loss.hpp"

namespace jaxmpm {

/// Where an inversion stands.
struct InversionState {
  const deck::Deck& deck;
  const Unknowns& unknowns;
  const RecordedLoss& loss;
  std::string backend;
  std::string stopped;                       // "running", "converged", "iterations", "stalled", "stopped" or "failed"
  std::optional<Variables> standard_errors;  // of the numbers, in the order of the variables
  std::vector<Comparison> comparisons;       // of the data with the run of the best values, once the search has ended
};

class InversionDirectory {
 public:
  explicit InversionDirectory(std::string path) : path_(std::move(path)) {}
  const std::string& path() const { return path_; }
  std::string json() const { return path_ + "/inversion.json"; }
  std::string h5() const { return path_ + "/inversion.h5"; }
  bool holds_inversion() const;
  /// Makes it and removes an inversion that is there. Throws IoError.
  void prepare() const;
  void clear(const deck::Deck& deck, const Unknowns& unknowns) const;
  /// Throws DeckError when a file that velocities start from is one that write() would replace.
  void protect_inputs(const deck::Deck& deck, const Unknowns& unknowns) const;
  /// Writes all files, each whole or not at all: velocities of particles, inversion.h5, inversion.json. Throws IoError.
  void write(const InversionState& state) const;
  /// Evaluations of the inversion that is there; none where there is no inversion. Throws IoError when it is damaged, DeckError when it is
  /// of another deck (what may differ: /output, /inverse/memory and disk, and the optimiser's iterations and tolerance).
  std::vector<RecordedEvaluation> read(const deck::Deck& deck, const Unknowns& unknowns) const;

 private:
  std::string path_;
};

}  // namespace jaxmpm
