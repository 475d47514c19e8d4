#pragma once
// A run of a deck as a function of its unknowns. The true one is RunObjective; tests have simpler ones.
#include "inverse/observer.hpp"
#include "inverse/unknowns.hpp"

namespace jaxmpm {

/// What one evaluation found and took.
struct Evaluation {
  double loss = 0;
  Values gradient;  // ∂loss/∂(number of the deck); empty where it was not asked for
  double forward_seconds = 0, gradient_seconds = 0;
  std::size_t peak_bytes = 0;                                // measured, of what the checkpoint schedule kept
  std::uint64_t particle_steps = 0, particles_at_kinks = 0;  // in all; within round-off of a branch
};

/// All of them throw NumericsError when the run becomes unstable, DeckError for values that the deck does not allow, and Stopped on
/// request.
class Objective {
 public:
  virtual ~Objective() = default;
  /// The loss alone.
  virtual Evaluation loss(const Values& values) = 0;
  virtual Evaluation gradient(const Values& values) = 0;
  /// Weighted residuals of the last evaluation, whose half sum of squares is its loss.
  virtual const std::vector<double>& residuals() const = 0;
  /// The data beside the readings of the last evaluation, observation by observation.
  virtual std::vector<Comparison> comparisons() const { return {}; }
  /// Later evaluations take the steps that a run with these values chooses. Has to be called before the first.
  virtual void renew_steps(const Values& values) = 0;
  /// Whether the steps depend on the values: false with a fixed /time/step.
  virtual bool steps_vary() const = 0;
  /// Whether the deck allows the values.
  virtual bool admits(const Values& values) const = 0;
  /// Name of what it runs on.
  virtual std::string backend() const { return "cpu"; }
};

}  // namespace jaxmpm
