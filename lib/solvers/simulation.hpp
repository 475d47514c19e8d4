#pragma once
// The run loop: steps, and at the right ones frames, gauges and checkpoints; stops on request; rescues the last good state when a step
// fails.
#include <functional>
#include <memory>

#include "core/error.hpp"
#include "core/stopwatch.hpp"
#include "solvers/solver.hpp"
#include "solvers/time_control.hpp"

namespace jaxmpm {

/// What a run leaves behind. Every call may throw IoError, also of what an earlier one had left to be written beside the steps; frame(),
/// gauges() and checkpoint() throw NumericsError instead of writing a non-finite value.
class Recorder {
 public:
  virtual ~Recorder() = default;
  virtual void frame(const Moment& now) = 0;
  virtual void gauges(const Moment& now) = 0;
  /// `state` is the solver's, `seconds` the wall time spent in steps so far.
  virtual void checkpoint(const Moment& now, SavedState state, double seconds) = 0;
  /// Returns when all of that is on disk.
  virtual void wait() = 0;
  /// Processor time of writing beside the steps so far, s.
  virtual double seconds_beside() const = 0;
  /// After every step; has to be cheap.
  virtual void progress(const Moment& now, double end) = 0;
};

struct RunSettings {
  double frame_interval = 0, gauge_interval = 0;  // s of physical time
  double checkpoint_seconds = 600;                // wall time between checkpoints; 0 or less: only at the end and when stopped
  double walltime_seconds = 0;                    // stop after this much wall time, 0: never
  std::function<bool()> stop_requested;           // asked after each step
};

/// Where a run begins: at step 0, or where a checkpoint left it (then what belongs to that moment is written already).
struct RunStart {
  Moment at;
  bool resumed = false;
  double seconds = 0;  // wall time in steps before
};

/// What a run leaves behind costs, s: wall time for which its steps waited, and processor time of writing beside them.
struct OutputSeconds {
  double frames = 0, gauges = 0, checkpoints = 0;
  double beside = 0;
};

struct RunOutcome {
  Moment at;
  bool finished = false;    // false: stopped with a checkpoint
  double seconds = 0;       // wall time in steps, with those before a resume
  std::uint64_t steps = 0;  // taken by this process
  double cpu_seconds = 0;   // processor time of these
  OutputSeconds output;     // of this process
};

class Simulation {
 public:
  Simulation(const deck::Time& time, const RunSettings& settings, Solver& solver, Recorder& recorder);
  /// What rounding of times the user should know of.
  std::vector<std::string> notices() const;
  double end() const { return control_.end(); }
  /// Runs to the end or until stopped. A NumericsError leaves after the last good state has been written, with a message that says where.
  RunOutcome run(const RunStart& start = {});

 private:
  void loop();
  void step();
  void record();
  void record_end();
  void record_gauges();
  void record_frame();
  void wait();  // for what is being written: counts as of frames, of which there are more
  bool should_stop() const;
  void checkpoint_if_due();
  void write_checkpoint();
  SavedState saved() const { return std::make_shared<const std::vector<RawArray>>(solver_.save()); }
  void remember();  // keeps the present state for a rescue
  void remember_if_cheap();
  Moment return_to(std::uint64_t step);  // restores the remembered state and repeats the steps up to `step`
  [[noreturn]] void rescue(const NumericsError& failure);
  std::string unwritten();
  std::string write_last_good();
  Moment next() const;

  TimeControl control_;
  OutputSchedule frames_, gauges_;
  RunSettings settings_;
  Solver& solver_;
  Recorder& recorder_;

  Moment now_;
  RunOutcome outcome_;
  Moment attempted_;           // end of the step that was last begun
  bool checkpointed_ = false;  // the present moment is on disk, or on its way there
  SavedState remembered_;
  Moment remembered_at_;
  double remember_cost_ = 0;
  Stopwatch started_, last_checkpoint_, last_remembered_;
};

}  // namespace jaxmpm
