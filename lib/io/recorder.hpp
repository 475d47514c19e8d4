#pragma once
// Writes what a run leaves behind into its results directory: frames, index with gauges, checkpoints, progress.
#include <optional>

#include "core/background.hpp"
#include "io/checkpoint.hpp"
#include "io/frame.hpp"
#include "io/progress.hpp"
#include "observe/gauge.hpp"
#include "solvers/simulation.hpp"

namespace jaxmpm {

/// Frames and checkpoints are written beside the steps, unless the steps are the host's and have one thread. They appear in the order in
/// which the run has them, and memory holds one of them at a time.
class ResultsRecorder : public Recorder {
 public:
  ResultsRecorder(const ResultsDirectory& directory, const deck::Deck& deck, const Model& model, Solver& solver, const std::string& backend,
                  bool quiet);
  /// Goes on from a checkpoint: takes over its list of frames and gauge readings and removes what was written after it.
  void resume(const Checkpoint& from);
  /// Writes what exists before the first step: obstacles and an index.
  void begin();
  /// Ends the line of progress, waits for what is being written, and writes the index with the last readings.
  void finish();

  void frame(const Moment& now) override;
  void gauges(const Moment& now) override;
  void checkpoint(const Moment& now, SavedState state, double seconds) override;
  void wait() override { writer_.wait(); }
  double seconds_beside() const override { return writer_.seconds_beside(); }
  void progress(const Moment& now, double end) override;

  std::size_t frame_count() const { return frames_.size(); }
  bool writes(const std::string& format) const;

 private:
  void write_frame_files(const Moment& now, const std::vector<FrameEntry>& frames) const;
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
  std::vector<BodySnapshot> snapshot_;  // of the frame that is being written
  Progress progress_;
  Background writer_;  // last, so that its job ends before what it reads goes
};

}  // namespace jaxmpm
