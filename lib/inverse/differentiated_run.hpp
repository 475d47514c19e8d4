#pragma once
// A run forward and back: loss and its gradient by the model, in a bounded amount of memory (docs/gradients.md).
#include <functional>
#include <memory>

#include "inverse/observer.hpp"
#include "inverse/snapshot_stack.hpp"

namespace jaxmpm {

/// The steps of a run: dt of each, and after which of them (0: before the first) each of the observer's times is reached.
struct StepSequence {
  std::vector<double> dt;          // s
  std::vector<std::size_t> looks;  // [time of the observer] number of steps done
  std::size_t most_blocks = 0;     // active in one step: kept states have room for what they sum
  std::uint64_t sorts = 0;         // of particles, the first included
  std::string note;                // moving_note() of the end
};

/// What a gradient may take up, bytes.
struct Room {
  std::size_t memory = 0, disk = 0;
};

/// What a gradient costs, known before it starts.
struct MemoryPlan {
  std::size_t steps = 0, snapshots = 0, on_disk = 0;  // snapshots kept at once, those on disk included
  std::size_t lean = 0;                               // of them, at least, where all states are kept and in memory
  std::size_t snapshot_bytes = 0, peak_bytes = 0, disk_bytes = 0;
  double recomputed_steps = 0;  // forward steps besides the first pass
  /// What to do where so many cannot be lean after all, as another run sorts more often or reaches further than the recorded one.
  std::size_t whole_snapshots = 0, whole_on_disk = 0;
};

struct RunCost {
  double forward_seconds = 0, reverse_seconds = 0;  // first pass; the rest, recomputation included
  std::size_t measured_peak_bytes = 0;              // of what the schedule kept
  std::size_t written_bytes = 0, read_bytes = 0;    // to and from the disk
  std::size_t particles_at_kinks = 0;               // particle-steps within round-off of a branch
};

/// Runs a model forward with steps chosen as `jaxmpm run` does, showing it to the observer; returns the steps taken.
/// Throws NumericsError when the run becomes unstable; `stop` (may be empty) is asked between steps and ends it with Stopped.
StepSequence record_run(const Model& model, Backend backend, Observer& observer, const std::function<bool()>& stop);

/// The same with given steps: exactly these, whatever the state would choose.
void replay_run(const Model& model, Backend backend, const StepSequence& steps, Observer& observer, const std::function<bool()>& stop);

/// Plan of a gradient within `room`, of whose memory `stack` may hold some already: snapshots go to the disk when memory has no room for
/// all. It is the memory of the stack's backend, which runs the steps. Throws Error (exit 2) when memory is too small for any plan.
MemoryPlan plan_gradient(const Model& model, const StepSequence& steps, const Room& room, const SnapshotStack& stack);

/// Loss (through the observer) and its gradient by the model. Branches (contact, return mapping, clamps) are differentiated as taken, dt is
/// held constant. The bits depend neither on the plan nor on the number of threads. `stack` serves gradient after gradient. Throws IoError
/// where the disk fails.
ModelGradient differentiate_run(const Model& model, const StepSequence& steps, Observer& observer, const MemoryPlan& plan,
                                SnapshotStack& stack, RunCost& cost, const std::function<bool()>& stop);

/// Thrown by the functions above when `stop` says so.
struct Stopped {};

}  // namespace jaxmpm
