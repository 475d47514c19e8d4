#pragma once
// Which steps a run takes, and at which of them it writes. Nothing here depends on the wall clock or on what is written, so the same deck
// always takes the same steps.
#include <cstdint>
#include <string>
#include <vector>

#include "deck/deck.hpp"

namespace jaxmpm {

/// Where a run stands: steps done, physical time (s), length of the last step (s; 0 before the first) and the time before it (s).
struct Moment {
  std::uint64_t step = 0;
  double time = 0;
  double dt = 0;
  double before = 0;
};

/// Sequence of steps. "auto": dt is the solver's stable step of the present state (which holds /time/cfl), and only the last one is
/// shortened to meet the end. Fixed: step k ends at k·dt exactly, and the run takes the whole number of steps nearest to the end.
class TimeControl {
 public:
  explicit TimeControl(const deck::Time& time);

  bool is_automatic() const { return fixed_ == 0; }
  double fixed_step() const { return fixed_; }
  double end() const { return end_; }  ///< time at which the run really ends, s
  bool done(const Moment& now) const;
  /// The moment after the next step. `stable` is the solver's stable step of the present state, s (unused when fixed).
  Moment after_next(const Moment& now, double stable) const;
  /// What the user should know: an end that is no whole number of fixed steps.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  double end_, fixed_;
  std::uint64_t last_step_ = 0;  // of a fixed sequence
  std::vector<std::string> notices_;
};

/// Times k · interval at which something is written: at the first step that reaches them or, with a fixed step, at the step nearest to
/// them.
class OutputSchedule {
 public:
  /// `what` names the schedule in notices ("frames", "gauges").
  OutputSchedule(const std::string& what, double interval, const TimeControl& control);
  /// Whether a time lies in the step that has just ended at `now`; step 0 always counts.
  bool due(const Moment& now) const;
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  std::uint64_t reached(std::uint64_t step, double time) const;  // number of scheduled times up to and including this moment
  double interval_, fixed_;
  std::vector<std::string> notices_;
};

}  // namespace jaxmpm
