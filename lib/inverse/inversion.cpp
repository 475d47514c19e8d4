#include "inverse/inversion.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "inverse/differentiated_run.hpp"
#include "inverse/misfit.hpp"
#include "inverse/optimizer.hpp"

namespace jaxmpm {
namespace {

constexpr std::size_t most_standard_errors = 20;  // unknowns up to which they are given: two runs for each
constexpr std::size_t most_gauss_newton = 100;    // unknowns: a Jacobian of more would cost more than many gradients
constexpr std::size_t most_shown = 4;             // numbers in the line of an iteration
constexpr double at_bound = 1e-9;                 // relative to the number, or 1
constexpr double widest_spacing = 0.1;            // of differences for standard errors, in parts of the variable's scale

void check_size(const deck::Optimizer& optimizer, std::size_t unknowns) {
  if (std::holds_alternative<deck::GaussNewton>(optimizer) && unknowns > most_gauss_newton)
    throw DeckError("/inverse/optimizer/method",
                    fmt::format("\"gauss_newton\" takes two runs for each unknown in each iteration, and here are "
                                "{} of them (at most {}); choose adam or lbfgs",
                                unknowns, most_gauss_newton));
}

std::string shown_numbers(const Unknowns& unknowns, const Variables& u) {
  const Values values = unknowns.values(u);
  std::string text;
  std::size_t shown = 0;
  for (const VariableBlock& block : unknowns.blocks()) {
    if (block.count > 1 || shown == most_shown) continue;
    text += fmt::format("  {} {:.6g}", unknowns.label(block.first), values.at(block.pointers.front()).at(0));
    ++shown;
  }
  return text;
}

}  // namespace

std::optional<Variables> standard_errors(const Linearisation& about, const Variables& slopes) {
  const std::size_t n = slopes.size();
  if (about.residuals <= n) return std::nullopt;
  const auto inverse = inverse_diagonal(about.normal);
  if (!inverse) return std::nullopt;
  const double variance = 2 * about.loss / static_cast<double>(about.residuals - n);
  Variables errors(n);
  for (std::size_t i = 0; i < n; ++i) errors[i] = std::abs(slopes[i]) * std::sqrt(variance * (*inverse)[i]);
  return errors;
}

Inversion::Inversion(const deck::Deck& deck, const Unknowns& unknowns, Objective& objective, const InversionDirectory& directory,
                     std::vector<RecordedEvaluation> before)
    : unknowns_(unknowns),
      objective_(objective),
      directory_(directory),
      optimizer_(deck::inverse_of(deck).optimizer),
      loss_(unknowns, objective, std::move(before), [this] { tell_evaluation(); }),
      state_{deck, unknowns, loss_, objective.backend(), "running", std::nullopt, {}} {
  check_size(optimizer_, unknowns.size());
  for (const RecordedEvaluation& one : loss_.evaluations()) iterations_ += one.is_iteration();
}

bool Inversion::run() {
  if (loss_.replaying()) spdlog::info("{} recorded evaluations are gone through again.", loss_.evaluations().size());
  std::string ended;
  try {
    ended = name_of(minimise(optimizer_, loss_));
    find_standard_errors();
    compare_with_data();
  } catch (const Stopped&) {
    take("stopped");
    return false;
  } catch (const NumericsError&) {
    take("failed");
    throw;
  } catch (const Error&) {
    if (!loss_.evaluations().empty()) note_failure();
    throw;
  }
  take(ended);
  tell_result();
  return true;
}

void Inversion::take(const std::string& stopped) {
  state_.stopped = stopped;
  directory_.write(state_);
}

/// Of the disk or of memory, in the midst of the inversion: that error is the one to tell.
void Inversion::note_failure() {
  try {
    take("failed");
  } catch (const Error&) {
    return;
  }
}

void Inversion::tell_evaluation() {
  directory_.write(state_);
  const RecordedEvaluation& last = loss_.evaluations().back();
  if (last.diverged) return spdlog::info("        the run fails there; a smaller change of the unknowns is tried");
  if (!last.is_iteration()) return;
  const Variables gradient(last.derivative.begin(), last.derivative.begin() + static_cast<std::ptrdiff_t>(last.u.size()));
  spdlog::info("{:5}  loss {:.6e}  |gradient| {:.3e}{}  {:.3g} + {:.3g} s", ++iterations_, last.loss,
               unknowns_.space().free_norm(last.u, gradient), shown_numbers(unknowns_, last.u), last.forward_seconds,
               last.gradient_seconds);
}

/// A standard error says how far an unknown may move until the data object. The differences that it comes from should reach as far: where
/// the loss is rough on closer scales they would tell of that, not of the data. Hence the larger of the errors from wide differences and
/// from differences as wide as those errors. A run beside the best values that becomes unstable tells nothing of wide ones.
std::optional<Variables> Inversion::errors_over_themselves(const Variables& best) {
  const SearchSpace& space = unknowns_.space();
  const auto errors_over = [&](const Variables& spacing) {
    return standard_errors(loss_.statistics(best, spacing), Variables(best.size(), 1.0));
  };
  const auto spacing_within = [&](const Variables& reach) {
    Variables spacing = space.scale;
    for (std::size_t i = 0; i < spacing.size(); ++i)
      spacing[i] *= std::clamp(reach[i] / space.scale[i], least_jacobian_spacing, widest_spacing);
    return spacing;
  };
  Variables wide(best.size(), 0.0);
  try {
    const auto errors = errors_over(spacing_within(space.scale));
    if (!errors) return std::nullopt;
    wide = *errors;
  } catch (const NumericsError&) {
  }
  auto errors = errors_over(spacing_within(wide));
  if (!errors) return std::nullopt;
  const Variables slopes = unknowns_.slopes(best);
  for (std::size_t i = 0; i < best.size(); ++i) (*errors)[i] = std::abs(slopes[i]) * std::max((*errors)[i], wide[i]);
  return errors;
}

void Inversion::find_standard_errors() {
  if (unknowns_.size() > most_standard_errors) return;
  const Variables best = loss_.best()->u;
  try {
    loss_.renew_steps(best);
    state_.standard_errors = errors_over_themselves(best);
  } catch (const NumericsError&) {
    return spdlog::warn("No standard errors: a run beside the best values became unstable.");
  }
  if (!state_.standard_errors)
    spdlog::warn(
        "No standard errors: these observations do not tell the unknowns apart (or are fewer than they). Fix some unknowns, share "
        "them, give them priors, or observe more.");
}

/// One more run, with the best values.
void Inversion::compare_with_data() {
  try {
    const Values best = unknowns_.values(loss_.best()->u);
    objective_.renew_steps(best);
    objective_.loss(best);
    state_.comparisons = objective_.comparisons();
  } catch (const NumericsError&) {
    spdlog::warn("No comparison with the data: the run with the best values became unstable with its own time steps.");
  }
}

/// What the bounds, or errors as wide as they, say of the result.
void Inversion::tell_bounds(const Variables& best) const {
  for (std::size_t i = 0; i < unknowns_.size() && unknowns_.size() <= most_standard_errors; ++i) {
    const auto [lower, upper] = unknowns_.bounds(i);
    const double value = unknowns_.number(i, best[i]), width = upper - lower;
    for (const bool above : {false, true})
      if (std::abs(value - (above ? upper : lower)) <= at_bound * std::max(1.0, std::abs(value)))
        spdlog::warn("{} is at its {} bound: the data want {} than the bounds allow, and the standard error does not hold.",
                     unknowns_.label(i), above ? "upper" : "lower", above ? "more" : "less");
    if (state_.standard_errors && (*state_.standard_errors)[i] > width / 2)
      spdlog::warn(
          "{}: its standard error is as wide as its bounds, so the observations hardly tell it; fix it, give it a prior, or observe "
          "more.",
          unknowns_.label(i));
  }
}

/// How far the best run is from the data.
void Inversion::tell_fit() const {
  for (std::size_t o = 0; o < state_.comparisons.size(); ++o) {
    const Misfit misfit = misfit_of(state_.comparisons[o]);
    spdlog::info("  observation {}: {} rows, read minus observed {:.3g} rms, {:.3g} on average, {:.3g} at most{}", o,
                 state_.comparisons[o].time.size(), misfit.rms, misfit.mean, misfit.largest,
                 misfit.unread > 0 ? fmt::format("; {} rows without material to read", misfit.unread) : "");
    if (misfit.is_no_noise())
      spdlog::warn(
          "What observation {} and the run differ by is no noise: it goes on from row to row (correlation {:.2f}; noise stays below {:.2f}). "
          "The model leaves something out, and the values may be off by more than standard errors say: see how far another transfer, half the "
          "cell or other observations move them.",
          o, misfit.correlation, misfit.largest_of_noise());
  }
}

void Inversion::tell_result() const {
  const RecordedEvaluation& best = *loss_.best();
  const char* const ended = state_.stopped == "converged"    ? "Converged"
                            : state_.stopped == "iterations" ? "Out of iterations"
                                                             : "No step lowers the loss any more";
  spdlog::info("{} after {} iterations and {} evaluations: loss {:.6e}", ended, iterations_, loss_.evaluations().size(), best.loss);
  const Values values = unknowns_.values(best.u);
  for (const VariableBlock& block : unknowns_.blocks()) {
    if (block.count > 1) {
      spdlog::info("  {}: {} {}", block.pointers.front(), block.count,
                   deck::is_network(block.pointers.front()) ? "weights" : "velocities of particles");
      continue;
    }
    const std::string error = state_.standard_errors ? fmt::format(" ± {:.2g}", (*state_.standard_errors)[block.first]) : "";
    for (const std::string& pointer : block.pointers) spdlog::info("  {} = {:.8g}{}", pointer, values.at(pointer).at(0), error);
  }
  tell_bounds(best.u);
  tell_fit();
  constexpr double mib = 1 << 20;
  if (loss_.peak_bytes() > 0) spdlog::info("Gradients kept {:.4g} MiB at most.", static_cast<double>(loss_.peak_bytes()) / mib);
}

}  // namespace jaxmpm
