#pragma once
// Writes what a run leaves behind into its results directory: frames, index with gauges, checkpoints, progress.
#include <optional>

#include "io/checkpoint.hpp"
#include "io/frame.hpp"
#include "io/progress.hpp"
#include "observe/gauge.hpp"
#include "solvers/simulation.hpp"

namespace jaxmpm {

class ResultsRecorder : public Recorder {
 public:
  ResultsRecorder(const ResultsDirectory& directory, const deck::Deck& deck, const Model& model, Solver& solver, const std::string& backend,
                  bool quiet);
  /// Goes on from a checkpoint: takes over its list of frames and gauge readings and removes what was written after it.
  void resume(const Checkpoint& from);
  /// Writes what exists before the first step: obstacles and an index.
  void begin();
  /// Writes the index with the last readings and ends the line of progress.
  void finish() {
    progress_.finish();
    write_index();
  }

  void frame(const Moment& now) override;
  void gauges(const Moment& now) override;
  void checkpoint(const Moment& now, const std::vector<RawArray>& state, double seconds) override;
  void progress(const Moment& now, double end) override;

  std::size_t frame_count() const { return frames_.size(); }
  bool writes(const std::string& format) const;

 private:
  void write_index() const;
  void drop_after(std::uint64_t step);

  const ResultsDirectory& directory_;
  const deck::Deck& deck_;
  const Model& model_;
  Solver& solver_;
  std::string backend_;
  std::vector<FrameBody> layout_;
  FieldSelection fields_;
  GaugeSet gauges_;
  std::vector<FrameEntry> frames_;
  Progress progress_;
};

}  // namespace jaxmpm
