#pragma once
// A stepper that also runs backwards: the discrete adjoint of its own step (docs/gradients.md).
#include "solvers/model_gradient.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// A state kept in memory, to go back to. Its buffers are used again when another state is kept in it.
class KeptState {
 public:
  virtual ~KeptState() = default;
};

class ReversibleSolver {
 public:
  virtual ~ReversibleSolver() = default;
  /// The stepper itself: the present state and the way forward.
  virtual Solver& forward() = 0;
  /// Bytes that one kept state takes.
  virtual std::size_t kept_bytes() const = 0;
  /// Keeps the present state in `into`, which is made when it is null.
  virtual void keep(std::unique_ptr<KeptState>& into) = 0;
  /// Makes a kept state the present one.
  virtual void go_back(const KeptState& kept) = 0;

  /// Starts a reverse run: all derivatives are zero.
  virtual void start_reverse() = 0;
  /// Adds derivatives of the loss by the present state, given by its snapshot in order of ids.
  virtual void add_gradient(const SnapshotGradient& by) = 0;
  /// Derivatives by the state after a step of dt from the present state become those by the present state. The present state is lost.
  virtual void step_adjoint(double dt) = 0;
  /// Derivatives by the model, once the reverse run has come to the first state.
  virtual ModelGradient gradient() const = 0;
  /// Particle-steps so far whose material stood within round-off of a branch.
  virtual std::uint64_t at_kinks() const = 0;
};

/// Builds a reversible stepper of a model on the host. Throws DeckError where the method has no adjoint (single precision).
std::unique_ptr<ReversibleSolver> make_reversible_solver(const Model& model);

}  // namespace jaxmpm
