#include "io/progress.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>

#include "core/logging.hpp"

namespace jaxmpm {

std::string duration(double seconds) {
  if (seconds < 1) return fmt::format("{:.2g} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02d} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02d} min", whole / 3600, whole / 60 % 60);
}

Progress::Progress(std::uint64_t particles, bool quiet) : particles_(particles), quiet_(quiet), terminal_(is_terminal()) {}

void Progress::finish() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

void Progress::update(const Moment& now, double end) {
  if (quiet_) return;
  if (!started_) {
    started_ = true;
    first_ = now;
    begin_.restart(), last_.restart();
    return;
  }
  const double interval = terminal_ ? 0.2 : 10;  // s
  if (last_.seconds() < interval) return;
  last_.restart();
  show(now, end, begin_.seconds());
}

void Progress::show(const Moment& now, double end, double elapsed) {
  const double steps = static_cast<double>(now.step - first_.step), advanced = now.time - first_.time;
  const double left = advanced > 0 ? elapsed * (end - now.time) / advanced : 0;
  const std::string line =
      fmt::format("{:5.1f}%  t = {:.6g} s  step {}  dt {:.3g} s  {:.3g} particle-steps/s  {} left", 100 * now.time / end, now.time,
                  now.step, now.dt, steps * static_cast<double>(particles_) / elapsed, duration(left));
  if (!terminal_) {
    spdlog::info("{}", line);
    return;
  }
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace jaxmpm
