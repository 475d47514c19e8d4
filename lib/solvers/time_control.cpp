#include "solvers/time_control.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "spdlog/fmt/fmt.h"

namespace jaxmpm {
namespace {

constexpr double whole_step_tolerance = 1e-9;  // steps; also relative to an interval, for sums of automatic steps

bool is_whole(double steps) { return std::abs(steps - std::round(steps)) <= std::max(whole_step_tolerance, 4e-16 * steps); }

}  // namespace

TimeControl::TimeControl(const deck::Time& time) : end_(time.end), fixed_(time.step.value_or(0)) {
  if (is_automatic()) return;
  const double steps = end_ / fixed_;
  last_step_ = static_cast<std::uint64_t>(std::max(1LL, std::llround(steps)));
  const double moved = static_cast<double>(last_step_) * fixed_;
  if (!is_whole(steps))
    notices_.push_back(fmt::format("/time/end {:.17g} s is no whole number of steps of {:.17g} s; the run ends at {:.17g} s (step {}).",
                                   end_, fixed_, moved, last_step_));
  end_ = moved;
}

bool TimeControl::done(const Moment& now) const { return is_automatic() ? now.time >= end_ : now.step >= last_step_; }

Moment TimeControl::after_next(const Moment& now, double dt) const {
  if (!is_automatic()) return {now.step + 1, static_cast<double>(now.step + 1) * fixed_, fixed_, now.time};
  if (!(dt > 0) || !std::isfinite(dt) || now.time + dt <= now.time)
    throw NumericsError(
        fmt::format("step {} at {:.9g} s: the automatic time step became {} s, so time stands still. The flow is no longer resolved: look "
                    "at the last frame, "
                    "and lower /time/cfl or raise the material's stiffness relative to its speed.",
                    now.step + 1, now.time, dt));
  // A rest of less than a billionth of a step is taken along, so that no sliver of a step is left for the end.
  if (now.time + dt * (1 + whole_step_tolerance) >= end_) return {now.step + 1, end_, end_ - now.time, now.time};
  return {now.step + 1, now.time + dt, dt, now.time};
}

OutputSchedule::OutputSchedule(const std::string& what, double interval, const TimeControl& control)
    : interval_(interval), fixed_(control.fixed_step()) {
  if (control.is_automatic()) return;
  const double steps = interval_ / fixed_;
  if (!is_whole(steps))
    notices_.push_back(fmt::format(
        "{} every {:.17g} s is no whole number of steps of {:.17g} s; each is taken at the nearest step and carries its exact time.", what,
        interval_, fixed_));
}

std::uint64_t OutputSchedule::reached(std::uint64_t step, double time) const {
  if (fixed_ == 0) return static_cast<std::uint64_t>(std::floor(time / interval_ + whole_step_tolerance)) + 1;
  if (interval_ <= fixed_) return step + 1;  // at every step
  // Number of k ≥ 0 with round(k · interval / dt) ≤ step; the estimate is corrected by the very rounding that places them.
  const auto place = [&](std::uint64_t k) { return std::llround(static_cast<double>(k) * interval_ / fixed_); };
  const auto at = static_cast<long long>(step);
  auto count = static_cast<std::uint64_t>((static_cast<double>(step) + 0.5) * fixed_ / interval_) + 1;
  while (count > 0 && place(count - 1) > at) --count;
  while (place(count) <= at) ++count;
  return count;
}

bool OutputSchedule::due(const Moment& now) const {
  if (now.step == 0) return true;
  return reached(now.step, now.time) > reached(now.step - 1, now.before);
}

}  // namespace jaxmpm
