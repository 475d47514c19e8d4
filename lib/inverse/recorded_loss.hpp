#pragma once
// The loss of an inversion, data and priors, as a function of the variables. Every evaluation is recorded; those of an earlier process are
// given back instead of computed, so that an optimiser that was stopped at any moment walks its way again to where it was and goes on.
#include <functional>
#include <optional>

#include "inverse/loss_function.hpp"
#include "inverse/objective.hpp"

namespace jaxmpm {

struct RecordedEvaluation {
  enum class Kind : unsigned char { gradient, loss, linearisation, statistics };
  Kind kind = Kind::gradient;
  bool diverged = false;
  Variables u;
  double loss = 0;
  /// The gradient; of a linearisation, also that for statistics, then JᵀJ row by row and the number of residuals.
  std::vector<double> derivative;
  double forward_seconds = 0, gradient_seconds = 0;
  bool is_iteration() const { return (kind == Kind::gradient || kind == Kind::linearisation) && !diverged; }
};

class RecordedLoss : public LossFunction {
 public:
  /// `before`: evaluations of an earlier process; `tell` is called after each new one.
  RecordedLoss(const Unknowns& unknowns, Objective& objective, std::vector<RecordedEvaluation> before, std::function<void()> tell);

  const SearchSpace& space() const override { return unknowns_.space(); }
  Sample gradient(const Variables& u) override;
  double loss(const Variables& u) override;
  /// By central differences of forward runs, one-sided ones at bounds: two runs for each variable and one more.
  Linearisation linearise(const Variables& u, const Variables& spacing) override;
  /// The same for standard errors, which is no iteration.
  Linearisation statistics(const Variables& u, const Variables& spacing);
  void renew_steps(const Variables& u) override;
  bool steps_vary() const override { return objective_.steps_vary(); }

  const std::vector<RecordedEvaluation>& evaluations() const { return evaluations_; }
  /// The evaluation with the lowest loss; null while there is none.
  const RecordedEvaluation* best() const;
  /// Whether the next evaluation is one of the earlier process.
  bool replaying() const { return replayed_ < evaluations_.size(); }
  std::size_t peak_bytes() const { return peak_bytes_; }

 private:
  using Kind = RecordedEvaluation::Kind;
  const RecordedEvaluation& evaluate(Kind kind, const Variables& u, const Variables& spacing = {});
  const RecordedEvaluation& replay(Kind kind, const Variables& u);
  void compute(RecordedEvaluation& evaluation, const Variables& spacing);
  void compute_gradient(RecordedEvaluation& evaluation);
  void compute_linearisation(RecordedEvaluation& evaluation, const Variables& spacing);
  std::vector<double> residuals_at(const Variables& u, RecordedEvaluation& evaluation);
  std::vector<double> column(const Variables& u, std::size_t variable, double spacing, const std::vector<double>& centre,
                             RecordedEvaluation& evaluation);
  void take_costs(const Evaluation& cost, RecordedEvaluation& evaluation);

  const Unknowns& unknowns_;
  Objective& objective_;
  std::vector<RecordedEvaluation> evaluations_;
  std::size_t replayed_ = 0, peak_bytes_ = 0;
  std::function<void()> tell_;
  std::optional<Variables> steps_of_;  // renewed at the next evaluation that is computed
  bool steps_asked_ = false, told_of_deck_ = false;
};

}  // namespace jaxmpm
