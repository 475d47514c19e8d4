#pragma once
// A stepper that also runs backwards: the discrete adjoint of its own step (docs/gradients.md).
#include <cstddef>

#include "solvers/model_gradient.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// A state to go back to, besides its numbers.
class KeptState {
 public:
  virtual ~KeptState() = default;
};

class ReversibleSolver {
 public:
  virtual ~ReversibleSolver() = default;
  /// The stepper itself: the present state and the way forward.
  virtual Solver& forward() = 0;
  /// Steps will have so many active blocks at most: kept states get room for their sums, without which the adjoint of a step has
  /// to scatter again.
  virtual void expect_blocks(std::size_t most) = 0;
  /// Bytes of the numbers of a kept state, of a lean one (as many where there are none), and of what states share until the next sort.
  virtual std::size_t kept_bytes() const = 0;
  virtual std::size_t lean_bytes() const = 0;
  virtual std::size_t shared_bytes() const = 0;
  /// Bytes that one more active block of the grid takes, with a tile in it.
  virtual std::size_t block_bytes() const = 0;
  /// Whether the present state may be kept lean: without what its particles move with, as the reverse run can gather that from the state
  /// before it, the last to be kept. So it is unless particles were sorted on the way from there, or are sorted next.
  virtual bool may_be_lean() const = 0;
  /// Keeps the present state; its numbers are written to `numbers`. From a lean one the way forward cannot be gone again.
  virtual std::unique_ptr<KeptState> keep(std::byte* numbers, bool lean) = 0;
  /// Adds to a kept state what the step from it, the last one taken, summed at the nodes.
  virtual void keep_sums(KeptState& kept, std::byte* numbers) = 0;
  /// Makes a kept state the present one.
  virtual void go_back(const KeptState& kept, const std::byte* numbers) = 0;

  /// Starts a reverse run: all derivatives are zero.
  virtual void start_reverse() = 0;
  /// Adds derivatives of the loss by the present state, given by its snapshot in order of ids.
  virtual void add_gradient(const SnapshotGradient& by) = 0;
  /// Derivatives by the state after a step of dt from a kept state become those by that; part of it may wait for the next call, whose step
  /// is the one before, or for end_reverse(). The present state is lost: go_back() to `kept` before add_gradient(). Until that,
  /// `numbers` stay as they are, or until the next call that takes a kept state, or end_reverse(), has returned.
  virtual void step_adjoint(double dt, const KeptState& kept, const std::byte* numbers) = 0;
  /// Does what waits.
  virtual void end_reverse() = 0;
  /// Derivatives by the model, once the reverse run has come to the first state and has been ended there.
  virtual ModelGradient gradient() const = 0;
  /// Particle-steps so far whose material stood within round-off of a branch.
  virtual std::uint64_t at_kinks() const = 0;
};

/// Builds a reversible stepper of a model. Throws as make_solver() does, and DeckError where the method has no adjoint (material at rest).
std::unique_ptr<ReversibleSolver> make_reversible_solver(const Model& model, Backend backend);

/// The memory that a backend's steppers compute in, where the numbers of kept states lie.
class StateMemory {
 public:
  virtual ~StateMemory() = default;
  virtual Backend backend() const = 0;
  /// A block that begins at a cache line. Throws where there is not so much.
  virtual std::byte* take(std::size_t bytes) = 0;
  virtual void give_back(std::byte* block) noexcept = 0;
  /// Copies to and from the host's memory, after everything that steppers have queued.
  virtual void copy_out(std::byte* host, const std::byte* block, std::size_t bytes) const = 0;
  virtual void copy_in(std::byte* block, const std::byte* host, std::size_t bytes) const = 0;
  /// Bytes in use now and, as far as it has been seen, at most.
  virtual std::size_t used() const = 0;
  virtual std::size_t most_used() const = 0;
};

std::shared_ptr<StateMemory> make_state_memory(Backend backend);

}  // namespace jaxmpm
