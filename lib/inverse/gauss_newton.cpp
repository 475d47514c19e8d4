#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "inverse/optimizer.hpp"

namespace jaxmpm {
namespace {

constexpr double first_damping = 1e-3, least_damping = 1e-12, most_damping = 1e12, damping_factor = 10;
constexpr double longest_move = 0.25;  // of a variable in one iteration, in parts of the width of its bounds
constexpr double least_fall = 1e-12;   // of the loss in parts of itself, without a tolerance: rounding
constexpr double refinement = 4;       // of the spacing, when it finds nothing better any more

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

/// Spacings of the Jacobian's differences: at first those of the deck, then as long as the steps that they lead to. Where a flow falls
/// apart (splashes) or is read from few particles (surfaces) the loss is rough on a scale much below that on which the data tell the
/// unknown, and exact derivatives lead nowhere: differences across the roughness do (implicit filtering: Kelley 2011, SIAM, chapters 4, 6).
class Spacings {
 public:
  Spacings(const SearchSpace& space, double first) : least_(space.scale), present_(space.scale) {
    for (double& h : least_) h *= least_jacobian_spacing;
    for (double& h : present_) h *= first;
  }
  const Variables& present() const { return present_; }
  bool least() const { return present_ == least_; }
  void follow(const Variables& from, const Variables& to) {
    for (std::size_t i = 0; i < to.size(); ++i) present_[i] = std::clamp(std::abs(to[i] - from[i]), least_[i], present_[i]);
  }
  void refine() {
    for (std::size_t i = 0; i < present_.size(); ++i) present_[i] = std::max(least_[i], present_[i] / refinement);
  }

 private:
  Variables least_, present_;
};

/// −gᵀδ − ½ δᵀ JᵀJ δ, by which the linearised loss falls from u to next.
double predicted_fall(const Linearisation& about, const Variables& u, const Variables& next) {
  double fall = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    fall -= about.gradient[i] * (next[i] - u[i]);
    for (std::size_t j = 0; j < u.size(); ++j) fall -= about.normal(i, j) * (next[i] - u[i]) * (next[j] - u[j]) / 2;
  }
  return fall;
}

/// Whether the differences told the truth about the step: the loss is smooth over it.
bool is_foretold(double fall, double predicted) {
  constexpr double part = 0.1;
  return std::abs(fall - predicted) <= part * predicted;
}

class GaussNewton {
 public:
  GaussNewton(const deck::GaussNewton& settings, LossFunction& loss)
      : settings_(settings), loss_(loss), spacings_(loss.space(), settings.spacing) {}

  Ending walk() {
    Variables u = loss_.space().start;
    for (int k = 1;; ++k) {
      loss_.renew_steps(u);
      const Linearisation about = linearised(u);
      if (about.loss == 0) return Ending::converged;
      const bool level = loss_.space().free_norm(u, about.gradient) == 0, better = !level && improve(u, about);
      if (!better || about.loss - reached_ <= settings_.tolerance.value_or(least_fall) * about.loss) {
        if (spacings_.least()) return better || level ? Ending::converged : Ending::stalled;
        spacings_.refine();
      }
      if (k == settings_.iterations) return Ending::iterations;
    }
  }

 private:
  /// Where a run beside u becomes unstable, closer ones are taken.
  Linearisation linearised(const Variables& u) {
    for (;; spacings_.refine()) {
      try {
        return loss_.linearise(u, spacings_.present());
      } catch (const NumericsError&) {
        if (spacings_.least()) throw;
      }
    }
  }

  /// Raises the damping until a step lowers the loss; a run that becomes unstable does not. Steps far below the spacing of the differences
  /// are nothing that these can judge.
  bool improve(Variables& u, const Linearisation& about) {
    for (; damping_ <= most_damping; damping_ *= damping_factor) {
      const auto step = damped_step(about, u, loss_.space(), damping_);
      if (!step) continue;
      const Variables next = moved(u, *step);
      if (next == u || below_spacing(u, next)) break;
      try {
        reached_ = loss_.loss(next);
      } catch (const NumericsError&) {
        continue;
      }
      if (!(reached_ < about.loss)) continue;
      if (is_foretold(about.loss - reached_, predicted_fall(about, u, next))) spacings_.follow(u, next);
      u = next;
      damping_ = std::max(least_damping, damping_ / damping_factor);
      return true;
    }
    damping_ = first_damping;  // for differences of another spacing
    return false;
  }

  bool below_spacing(const Variables& u, const Variables& next) const {
    if (spacings_.least()) return false;
    constexpr double part = 0.1;
    for (std::size_t i = 0; i < u.size(); ++i)
      if (std::abs(next[i] - u[i]) > part * spacings_.present()[i]) return false;
    return true;
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
  Spacings spacings_;
  double damping_ = first_damping, reached_ = 0;
};

}  // namespace

Ending minimise(const deck::GaussNewton& gauss_newton, LossFunction& loss) { return GaussNewton(gauss_newton, loss).walk(); }

}  // namespace jaxmpm
