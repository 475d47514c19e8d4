#pragma once
// How far a run is, its rate and the time left: on a terminal one line that is rewritten, otherwise plain lines now and then.
#include <string>

#include "core/stopwatch.hpp"
#include "solvers/time_control.hpp"

namespace jaxmpm {

class Progress {
 public:
  Progress(std::uint64_t particles, bool quiet);
  ~Progress() { finish(); }
  /// After each step; costs a look at the clock. `end` is the physical time at which the run ends.
  void update(const Moment& now, double end);
  /// Clears the line on a terminal, so that what is told next starts on a line of its own.
  void finish();

 private:
  void show(const Moment& now, double end, double elapsed);
  std::uint64_t particles_;
  bool quiet_, terminal_, shown_ = false, started_ = false;
  Moment first_;
  Stopwatch begin_, last_;
};

/// Seconds as a person reads them: "12 s", "3 min 20 s", "2 h 05 min".
std::string duration(double seconds);

}  // namespace jaxmpm
