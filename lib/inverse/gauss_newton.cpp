#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "inverse/optimizer.hpp"

namespace jaxmpm {
namespace {

constexpr double first_damping = 1e-3, least_damping = 1e-12, most_damping = 1e12, damping_factor = 10;
constexpr double longest_move = 0.25;  // of a variable in one iteration, in parts of the width of its bounds
constexpr double least_fall = 1e-12;   // of the loss in parts of itself, without a tolerance: rounding

/// (JᵀJ + λ diag JᵀJ) δ = −Jᵀr over the variables that no bound blocks (Marquardt 1963, Eq 22 with his scaling); zero elsewhere.
std::optional<Variables> damped_step(const Linearisation& about, const Variables& u, const SearchSpace& space, double damping) {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < u.size(); ++i)
    if (!space.blocked(u, i, -about.gradient[i]) && about.normal(i, i) > 0) free.push_back(i);
  SquareMatrix matrix(free.size());
  std::vector<double> right;
  for (std::size_t a = 0; a < free.size(); ++a) {
    for (std::size_t b = 0; b < free.size(); ++b) matrix(a, b) = about.normal(free[a], free[b]);
    matrix(a, a) *= 1 + damping;
    right.push_back(-about.gradient[free[a]]);
  }
  const auto solution = solve(matrix, right);
  if (!solution) return std::nullopt;
  Variables step(u.size(), 0.0);
  for (std::size_t a = 0; a < free.size(); ++a) step[free[a]] = (*solution)[a];
  return step;
}

class GaussNewton {
 public:
  explicit GaussNewton(const deck::GaussNewton& settings, LossFunction& loss) : settings_(settings), loss_(loss) {}

  Ending walk() {
    Variables u = loss_.space().start;
    for (int k = 1;; ++k) {
      loss_.renew_steps(u);
      const Linearisation about = loss_.linearise(u);
      if (about.loss == 0 || loss_.space().free_norm(u, about.gradient) == 0) return Ending::converged;
      const double before = about.loss;
      if (!improve(u, about)) return Ending::stalled;
      if (before - reached_ <= settings_.tolerance.value_or(least_fall) * before) return Ending::converged;
      if (k == settings_.iterations) return Ending::iterations;
    }
  }

 private:
  /// Raises the damping until a step lowers the loss; a run that becomes unstable does not.
  bool improve(Variables& u, const Linearisation& about) {
    for (; damping_ <= most_damping; damping_ *= damping_factor) {
      const auto step = damped_step(about, u, loss_.space(), damping_);
      if (!step) continue;
      const Variables next = moved(u, *step);
      if (next == u) return false;
      try {
        reached_ = loss_.loss(next);
      } catch (const NumericsError&) {
        continue;
      }
      if (!(reached_ < about.loss)) continue;
      u = next;
      damping_ = std::max(least_damping, damping_ / damping_factor);
      return true;
    }
    return false;
  }

  /// u + step within the bounds. What the data hardly speak of yet (the friction of a floor that the front has not reached) would jump from
  /// bound to bound, and could end where it is never seen: hence longest_move.
  Variables moved(const Variables& u, const Variables& step) const {
    const SearchSpace& space = loss_.space();
    Variables next = u;
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double most = longest_move * (space.upper[i] - space.lower[i]);
      next[i] += std::clamp(step[i], -most, most);
    }
    return space.projected(next);
  }

  const deck::GaussNewton& settings_;
  LossFunction& loss_;
  double damping_ = first_damping, reached_ = 0;
};

}  // namespace

Ending minimise(const deck::GaussNewton& gauss_newton, LossFunction& loss) { return GaussNewton(gauss_newton, loss).walk(); }

}  // namespace jaxmpm
