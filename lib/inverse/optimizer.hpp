#pragma once
// Optimisers: each walks the loss from the start of its search space. What it finds is the best of its evaluations, which the loss keeps.
#include "deck/inverse.hpp"
#include "inverse/loss_function.hpp"

namespace jaxmpm {

/// Why an optimiser ended: the loss falls by less than the tolerance (or its gradient vanishes), the iterations of the deck are done, or no
/// step along its direction lowers the loss any more.
enum class Ending { converged, iterations, stalled };

/// "converged", "iterations" or "stalled".
std::string name_of(Ending ending);

/// Walks. A run that becomes unstable shortens the step; the first one throws NumericsError.
Ending minimise(const deck::Optimizer& optimizer, LossFunction& loss);

/// Adam (Kingma & Ba 2015, Algorithm 1) with the learning rate times decay after each iteration, projected to the bounds.
Ending minimise(const deck::Adam& adam, LossFunction& loss);

/// NLopt's LD_LBFGS (Nocedal 1980; Luksan's code), which keeps to bounds. Where steps vary it starts anew from its best point with renewed
/// steps now and then, so that it always minimises one function.
Ending minimise(const deck::Lbfgs& lbfgs, LossFunction& loss);

/// Gauss–Newton steps damped by Marquardt's (1963) factor on the diagonal, projected to the bounds.
Ending minimise(const deck::GaussNewton& gauss_newton, LossFunction& loss);

}  // namespace jaxmpm
