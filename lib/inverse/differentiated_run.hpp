#pragma once
// A run forward and back: loss and its gradient by the model, in a bounded amount of memory (docs/gradients.md).
#include <functional>
#include <memory>

#include "inverse/observer.hpp"
#include "inverse/snapshot_pool.hpp"

namespace jaxmpm {

/// The steps of a run: dt of each, and after which of them (0: before the first) each of the observer's times is reached.
struct StepSequence {
  std::vector<double> dt;          // s
  std::vector<std::size_t> looks;  // [time of the observer] number of steps done
};

/// What a gradient costs, known before it starts.
struct MemoryPlan {
  std::size_t steps = 0, snapshots = 0;  // snapshots kept at once, in memory and on disk
  std::size_t snapshot_bytes = 0, peak_bytes = 0;
  double recomputed_steps = 0;  // forward steps besides the first pass
};

struct RunCost {
  double forward_seconds = 0, reverse_seconds = 0;  // first pass; the rest, recomputation included
  std::size_t measured_peak_bytes = 0;              // of what the schedule kept
  std::size_t particles_at_kinks = 0;               // particle-steps within round-off of a branch
};

/// Runs a model forward with steps chosen as `jaxmpm run` does, showing it to the observer; returns the steps taken.
/// Throws NumericsError when the run becomes unstable; `stop` (may be empty) is asked between steps and ends it with Stopped.
StepSequence record_run(const Model& model, Observer& observer, const std::function<bool()>& stop);

/// The same with given steps: exactly these, whatever the state would choose.
void replay_run(const Model& model, const StepSequence& steps, Observer& observer, const std::function<bool()>& stop);

/// Plan of a gradient within `memory_bytes`, of which `pool` may hold some already. Throws Error (exit 2) when not even one snapshot fits.
MemoryPlan plan_gradient(const Model& model, const StepSequence& steps, std::size_t memory_bytes, const SnapshotPool& pool);

/// Loss (through the observer) and its gradient by the model. Branches (contact, return mapping, clamps) are differentiated as taken, dt is
/// held constant. The bits depend neither on the plan nor on the number of threads. `pool` serves gradient after gradient.
ModelGradient differentiate_run(const Model& model, const StepSequence& steps, Observer& observer, const MemoryPlan& plan,
                                SnapshotPool& pool, RunCost& cost, const std::function<bool()>& stop);

/// Thrown by the functions above when `stop` says so.
struct Stopped {};

}  // namespace jaxmpm
