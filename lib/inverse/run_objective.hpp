#pragma once
// The objective that invert and gradient work on: a run of the deck with given values, seen by the observer of its observations.
#include <functional>

#include "inverse/differentiated_run.hpp"
#include "inverse/objective.hpp"

namespace jaxmpm {

class RunObjective : public Objective {
 public:
  /// Of a deck with /inverse; `pointers` are those that gradients are asked for. Reads the observed files. `stop` is asked between steps
  /// and ends an evaluation with Stopped. Throws DeckError and IoError.
  RunObjective(const deck::Deck& deck, Backend backend, std::vector<std::string> pointers, std::function<bool()> stop);

  Evaluation loss(const Values& values) override;
  Evaluation gradient(const Values& values) override;
  const std::vector<double>& residuals() const override { return observer_->residuals(); }
  std::vector<Comparison> comparisons() const override { return observer_->comparisons(); }
  void renew_steps(const Values& values) override;
  bool steps_vary() const override { return !deck_.time.step; }
  bool admits(const Values& values) const override;
  std::string backend() const override;

 private:
  void tell_plan(const MemoryPlan& plan) const;
  void tell_disk(const RunCost& cost) const;

  deck::Deck deck_;  // without /inverse
  Backend backend_;
  std::vector<std::string> pointers_;
  Room room_;  // of the schedule
  std::function<bool()> stop_;
  std::unique_ptr<Observer> observer_;
  StepSequence steps_;
  SnapshotStack snapshots_;
  bool told_ = false;  // what a gradient takes
};

/// What /inverse/memory and /inverse/disk give to a gradient.
Room room_of(const deck::Inverse& inverse);

}  // namespace jaxmpm
