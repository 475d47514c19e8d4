#include "solvers/simulation.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/runtime.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {
namespace {

/// Adds the time until the end of its scope to a sum, and takes its processor time from the run's: that is the one of steps alone.
class OutputTimed {
 public:
  OutputTimed(double& sum, double& cpu) : timed_(sum), cpu_(cpu), begin_(processor_seconds()) {}
  ~OutputTimed() { cpu_ -= processor_seconds() - begin_; }
  OutputTimed(const OutputTimed&) = delete;
  OutputTimed& operator=(const OutputTimed&) = delete;

 private:
  Timed timed_;
  double& cpu_;
  double begin_;
};

// A state is kept in memory so rarely that it costs at most one part in this of the run, and a rescue repeats no more than that many times
// its cost.
constexpr double rescue_share = 200;

}  // namespace

Simulation::Simulation(const deck::Time& time, const RunSettings& settings, Solver& solver, Recorder& recorder)
    : control_(time),
      frames_("/output/interval: a frame", settings.frame_interval, control_),
      gauges_("/output/gauge_interval: a gauge", settings.gauge_interval, control_),
      settings_(settings),
      solver_(solver),
      recorder_(recorder) {}

std::vector<std::string> Simulation::notices() const {
  std::vector<std::string> all = control_.notices();
  for (const OutputSchedule* schedule : {&frames_, &gauges_}) all.insert(all.end(), schedule->notices().begin(), schedule->notices().end());
  return all;
}

RunOutcome Simulation::run(const RunStart& start) {
  started_.restart(), last_checkpoint_.restart();
  now_ = start.at;
  outcome_ = {start.at, false, start.seconds, 0, 0, {}};
  const double cpu_before = processor_seconds();
  checkpointed_ = start.resumed;
  attempted_ = now_;
  remember();
  try {
    if (!start.resumed) record();
    loop();
    if (outcome_.finished) record_end();
    wait();
    outcome_.output.beside = recorder_.seconds_beside();
    outcome_.cpu_seconds += processor_seconds() - cpu_before - outcome_.output.beside;
  } catch (const NumericsError& failure) {
    rescue(failure);
  }
  outcome_.at = now_;
  return outcome_;
}

void Simulation::loop() {
  while (!control_.done(now_)) {
    if (should_stop()) {
      if (!checkpointed_) write_checkpoint();
      return;
    }
    checkpoint_if_due();
    remember_if_cheap();
    step();
    record();
  }
  outcome_.finished = true;
}

Moment Simulation::next() const { return control_.after_next(now_, control_.is_automatic() ? solver_.stable_step() : 0); }

void Simulation::step() {
  attempted_ = {now_.step + 1, now_.time, 0, now_.time};  // choosing the step may fail already
  const Moment after = attempted_ = next();
  // The end shortens its step and is recorded out of turn. The checkpoint of a finished run is therefore the state before its last step,
  // from which a later end continues as if this one had never been.
  if (control_.done(after) && !checkpointed_) write_checkpoint();
  {
    const Timed timed(outcome_.seconds);
    solver_.step(after.dt);
  }
  ++outcome_.steps;
  now_ = after;
  checkpointed_ = false;
  recorder_.progress(now_, control_.end());
}

void Simulation::record() {
  if (gauges_.due(now_)) record_gauges();
  if (frames_.due(now_)) record_frame();
}

void Simulation::record_end() {
  if (!gauges_.due(now_)) record_gauges();
  if (!frames_.due(now_)) record_frame();
}

void Simulation::record_gauges() {
  const OutputTimed timed(outcome_.output.gauges, outcome_.cpu_seconds);
  recorder_.gauges(now_);
}

void Simulation::record_frame() {
  const OutputTimed timed(outcome_.output.frames, outcome_.cpu_seconds);
  recorder_.frame(now_);
}

void Simulation::wait() {
  const OutputTimed timed(outcome_.output.frames, outcome_.cpu_seconds);
  recorder_.wait();
}

bool Simulation::should_stop() const {
  if (settings_.stop_requested && settings_.stop_requested()) return true;
  return settings_.walltime_seconds > 0 && started_.seconds() >= settings_.walltime_seconds;
}

void Simulation::checkpoint_if_due() {
  if (settings_.checkpoint_seconds > 0 && last_checkpoint_.seconds() >= settings_.checkpoint_seconds && !checkpointed_) write_checkpoint();
}

void Simulation::write_checkpoint() {
  remember();
  const OutputTimed timed(outcome_.output.checkpoints, outcome_.cpu_seconds);
  recorder_.checkpoint(now_, remembered_, outcome_.seconds);
  last_checkpoint_.restart();
  checkpointed_ = true;
}

void Simulation::remember() {
  const OutputTimed timed(outcome_.output.checkpoints, outcome_.cpu_seconds);
  if (remembered_.use_count() > 1) recorder_.wait();  // it is being written: there would be three states in memory
  const Stopwatch watch;
  remembered_ = saved();
  remembered_at_ = now_;
  remember_cost_ = watch.seconds();
  last_remembered_.restart();
}

void Simulation::remember_if_cheap() {
  constexpr double at_least = 1;  // s
  if (last_remembered_.seconds() >= std::max(at_least, rescue_share * remember_cost_)) remember();
}

Moment Simulation::return_to(std::uint64_t step) {
  solver_.restore(*remembered_);
  now_ = remembered_at_;
  while (now_.step < step) {
    const Moment after = next();
    solver_.step(after.dt);
    now_ = after;
  }
  return now_;
}

void Simulation::rescue(const NumericsError& failure) {
  std::string where = unwritten();
  try {
    where = write_last_good() + where;
  } catch (const std::exception& second) {
    where = fmt::format("The last good state could not be written ({}); the frames and checkpoints before it are whole.", second.what()) +
            where;
  }
  throw NumericsError(
      fmt::format("{}\nin step {}, from {:.9g} s to {:.9g} s (dt {:.4g} s). Take a smaller {}, and look for a load or velocity that the "
                  "material's stiffness cannot carry.\n{}",
                  failure.what(), attempted_.step, attempted_.before, attempted_.time, attempted_.dt,
                  control_.is_automatic() ? "/time/cfl" : "/time/step (or \"auto\")", where));
}

/// Waits for what is being written, and tells what went wrong with it.
std::string Simulation::unwritten() {
  try {
    recorder_.wait();
    return {};
  } catch (const IoError& lost) {
    return fmt::format("\nBefore that, it {}", lost.what());
  }
}

std::string Simulation::write_last_good() {
  const auto write = [&] {
    recorder_.checkpoint(now_, saved(), outcome_.seconds);
    recorder_.frame(now_);
    recorder_.wait();
    return fmt::format("The last good state (step {}, {:.9g} s) is in the last frame and in the checkpoint.", now_.step, now_.time);
  };
  try {
    return_to(attempted_.step > 0 ? attempted_.step - 1 : 0);
    return write();
  } catch (const NumericsError&) {  // a device may add in another order and fail earlier: what was remembered is good
    return_to(remembered_at_.step);
    return write();
  }
}

}  // namespace jaxmpm
