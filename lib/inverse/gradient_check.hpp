#pragma once
// Whether the gradient of a deck is that of its loss: Taylor remainders, differences and dot products against forward runs, all with the
// same steps.
#include "inverse/loss_function.hpp"
#include "inverse/objective.hpp"

namespace jaxmpm {

/// Along u + ε d, with d of seeded normal deviates times the variables' scales (turned inwards at bounds).
struct DirectionCheck {
  std::vector<double> step;       // ε, from large to small
  std::vector<double> remainder;  // |L(u + ε d) − L(u) − ε g·d|
  double slope = 0;               // of log remainder over log ε, over the three decades where it is nearest to 2; 0 where there are none
  double derivative = 0;          // g·d by the adjoint
  double difference = 0;          // of the loss along d, of second order: the nearest to g·d over the steps
  double dot_product = 0;         // ⟨J d, r⟩ with J d by differences of the residuals: what Jᵀr = g must give
  double size = 0;                // of g·d if its parts were independent: what an error of it is relative to, at least
  double scatter = 0;             // of the differences over the finest steps
  bool smooth = false;            // slope 2 ± 0.1, or remainders of rounding alone
  bool fine = false;              // only the difference over a finer step than the first agrees, or comes nearest
};

struct VariableCheck {
  std::string label;
  double derivative = 0, difference = 0;  // by the variable; the difference nearest over three spacings or more
  double error = 0;                       // relative, to a thousandth of what the most important variable does at least
  double scatter = 0;                     // of the differences over the finest spacings, relative like the error
  bool fine = false;                      // only the difference over a finer spacing than these agrees, or comes nearest
};

struct GradientCheck {
  double loss = 0;
  std::vector<DirectionCheck> directions;
  std::vector<VariableCheck> variables;  // all of them, or a seeded choice of 20
  double curvature = 0;                  // the largest second derivative of the loss along the directions
  std::uint64_t particle_steps = 0, particles_at_kinks = 0;
  bool good = false;
  std::string verdict;
};

/// At the start of the unknowns, priors included; takes some sixteen forward runs for each direction and up to six for each variable,
/// twice as many where none of the differences agree.
GradientCheck check_gradient(const Unknowns& unknowns, Objective& objective, std::size_t directions, std::uint64_t seed);

}  // namespace jaxmpm
