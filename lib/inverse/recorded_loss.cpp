#include "inverse/recorded_loss.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/error.hpp"
#include "inverse/differences.hpp"
#include "inverse/linear_algebra.hpp"

namespace jaxmpm {
namespace {

double half_square(const std::vector<double>& residuals) { return dot(residuals, residuals) / 2; }

/// Residuals that are not masked: a masked one is zero and stays it, whatever the variables do.
std::size_t telling(const std::vector<double>& residuals, const std::vector<std::vector<double>>& columns) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < residuals.size(); ++m)
    count += residuals[m] != 0 || std::any_of(columns.begin(), columns.end(), [m](const auto& column) { return column[m] != 0; });
  return count;
}

Linearisation linearisation_of(const RecordedEvaluation& found) {
  const std::size_t n = found.u.size();
  const auto normal = found.derivative.begin() + static_cast<std::ptrdiff_t>(n);
  Linearisation result{found.loss, {found.derivative.begin(), normal}, SquareMatrix(n), static_cast<std::size_t>(found.derivative.back())};
  std::copy(normal, normal + static_cast<std::ptrdiff_t>(n * n), result.normal.entries.begin());
  return result;
}

}  // namespace

RecordedLoss::RecordedLoss(const Unknowns& unknowns, Objective& objective, std::vector<RecordedEvaluation> before,
                           std::function<void()> tell)
    : unknowns_(unknowns), objective_(objective), evaluations_(std::move(before)), tell_(std::move(tell)) {}

LossFunction::Sample RecordedLoss::gradient(const Variables& u) {
  const RecordedEvaluation& found = evaluate(Kind::gradient, u);
  return {found.loss, found.derivative};
}

double RecordedLoss::loss(const Variables& u) { return evaluate(Kind::loss, u).loss; }

Linearisation RecordedLoss::linearise(const Variables& u, const Variables& spacing) {
  return linearisation_of(evaluate(Kind::linearisation, u, spacing));
}

Linearisation RecordedLoss::statistics(const Variables& u, const Variables& spacing) {
  return linearisation_of(evaluate(Kind::statistics, u, spacing));
}

void RecordedLoss::renew_steps(const Variables& u) {
  if (steps_asked_ && !objective_.steps_vary()) return;
  steps_asked_ = true;
  steps_of_ = u;
}

const RecordedEvaluation* RecordedLoss::best() const {
  const RecordedEvaluation* lowest = nullptr;
  for (const RecordedEvaluation& one : evaluations_)
    if (!one.diverged && (lowest == nullptr || one.loss < lowest->loss)) lowest = &one;
  return lowest;
}

const RecordedEvaluation& RecordedLoss::evaluate(Kind kind, const Variables& u, const Variables& spacing) {
  // Standard errors came last, when the iterations were done; now there are more.
  if (replaying() && kind != Kind::statistics && evaluations_[replayed_].kind == Kind::statistics) evaluations_.resize(replayed_);
  if (replaying()) return replay(kind, u);
  RecordedEvaluation fresh;
  fresh.kind = kind;
  fresh.u = u;
  std::string reason;
  try {
    compute(fresh, spacing);
  } catch (const NumericsError& error) {
    fresh.diverged = true;
    reason = error.what();
  } catch (const DeckError& error) {  // beyond what the unknown's own key allows: stepped back from, but where the search starts
    if (evaluations_.empty()) throw;
    fresh.diverged = true;
    reason = error.what();
    if (!told_of_deck_)
      spdlog::warn("{}; the search led there and tries a smaller change. Bounds of the unknown would keep it out.", reason);
    told_of_deck_ = true;
  }
  evaluations_.push_back(std::move(fresh));
  ++replayed_;
  tell_();
  if (evaluations_.back().diverged) throw NumericsError(reason);
  return evaluations_.back();
}

const RecordedEvaluation& RecordedLoss::replay(Kind kind, const Variables& u) {
  const RecordedEvaluation& found = evaluations_[replayed_];
  if (found.kind != kind || found.u != u)
    throw IoError(
        "evaluation " + std::to_string(replayed_ + 1) +
        " of the recorded inversion is not the one that this program would make: it is of another version, or was made on another "
        "kind of processor. Start anew with --overwrite, or choose another directory with -o.");
  ++replayed_;
  if (found.diverged) throw NumericsError("the run became unstable in an earlier process, as its record says.");
  return found;
}

void RecordedLoss::compute(RecordedEvaluation& evaluation, const Variables& spacing) {
  if (steps_of_) objective_.renew_steps(unknowns_.values(*steps_of_));
  steps_of_.reset();
  if (evaluation.kind == Kind::gradient) compute_gradient(evaluation);
  else if (evaluation.kind == Kind::loss) evaluation.loss = half_square(residuals_at(evaluation.u, evaluation));
  else compute_linearisation(evaluation, spacing);
}

void RecordedLoss::compute_gradient(RecordedEvaluation& evaluation) {
  const Evaluation found = objective_.gradient(unknowns_.values(evaluation.u));
  take_costs(found, evaluation);
  evaluation.loss = found.loss + half_square(unknowns_.prior_residuals(evaluation.u));
  evaluation.derivative = unknowns_.gradient(evaluation.u, found.gradient);
  unknowns_.add_prior_gradient(evaluation.u, evaluation.derivative);
}

/// Residuals of the data, then those of the priors.
std::vector<double> RecordedLoss::residuals_at(const Variables& u, RecordedEvaluation& evaluation) {
  take_costs(objective_.loss(unknowns_.values(u)), evaluation);
  std::vector<double> residuals = objective_.residuals();
  const Variables prior = unknowns_.prior_residuals(u);
  residuals.insert(residuals.end(), prior.begin(), prior.end());
  return residuals;
}

std::vector<double> RecordedLoss::column(const Variables& u, std::size_t variable, double spacing, const std::vector<double>& centre,
                                         RecordedEvaluation& evaluation) {
  const Difference rule = difference(unknowns_, objective_, u, variable, spacing);
  std::vector<double> derivative(centre.size(), 0.0);
  for (std::size_t k = 0; k < rule.offset.size(); ++k) {
    Variables moved = u;
    moved[variable] += rule.offset[k];
    const std::vector<double> residuals = rule.offset[k] == 0 ? centre : residuals_at(moved, evaluation);
    for (std::size_t m = 0; m < derivative.size(); ++m) derivative[m] += rule.weight[k] * residuals[m];
  }
  return derivative;
}

void RecordedLoss::compute_linearisation(RecordedEvaluation& evaluation, const Variables& spacing) {
  const std::size_t n = evaluation.u.size();
  const std::vector<double> residuals = residuals_at(evaluation.u, evaluation);
  evaluation.loss = half_square(residuals);
  std::vector<std::vector<double>> columns;
  RecordedEvaluation differences;  // their runs count as the gradient's
  for (std::size_t i = 0; i < n; ++i) columns.push_back(column(evaluation.u, i, spacing[i], residuals, differences));
  evaluation.gradient_seconds = differences.forward_seconds;
  for (std::size_t i = 0; i < n; ++i) evaluation.derivative.push_back(dot(columns[i], residuals));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) evaluation.derivative.push_back(dot(columns[i], columns[j]));
  evaluation.derivative.push_back(static_cast<double>(telling(residuals, columns)));
}

void RecordedLoss::take_costs(const Evaluation& cost, RecordedEvaluation& evaluation) {
  evaluation.forward_seconds += cost.forward_seconds;
  evaluation.gradient_seconds += cost.gradient_seconds;
  peak_bytes_ = std::max(peak_bytes_, cost.peak_bytes);
}

}  // namespace jaxmpm
