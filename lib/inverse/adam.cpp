#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "core/error.hpp"
#include "inverse/optimizer.hpp"

namespace jaxmpm {
namespace {

// Values that Kingma & Ba recommend.
constexpr double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;
constexpr int most_halvings = 20;  // of a step into an unstable run

class Adam {
 public:
  Adam(const deck::Adam& adam, LossFunction& loss)
      : adam_(adam), loss_(loss), rate_(adam.learning_rate), mean_(loss.space().size(), 0.0), square_(loss.space().size(), 0.0) {}

  Ending walk() {
    Variables u = loss_.space().start;
    LossFunction::Sample sample = evaluate(u);
    for (int k = 1;; ++k) {
      if (settled(sample.loss) || loss_.space().free_norm(u, sample.gradient) == 0) return Ending::converged;
      if (k == adam_.iterations) return Ending::iterations;
      if (!advance(u, sample, k)) return Ending::stalled;
    }
  }

 private:
  LossFunction::Sample evaluate(const Variables& u) {
    loss_.renew_steps(u);
    return loss_.gradient(u);
  }

  /// m ← β₁m + (1 − β₁)g, v ← β₂v + (1 − β₂)g², u ← P(u − α m̂/(√v̂ + ε)). After a run that became unstable: half the rate, and no inertia
  /// that would lead there again.
  bool advance(Variables& u, LossFunction::Sample& sample, int k) {
    Variables step(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double g = sample.gradient[i];
      mean_[i] = beta1 * mean_[i] + (1 - beta1) * g;
      square_[i] = beta2 * square_[i] + (1 - beta2) * g * g;
      step[i] = -(mean_[i] / (1 - std::pow(beta1, k))) / (std::sqrt(square_[i] / (1 - std::pow(beta2, k))) + epsilon);
    }
    for (int halvings = 0; halvings <= most_halvings; ++halvings, rate_ /= 2) {
      const Variables next = moved(u, step);
      try {
        sample = evaluate(next);
        u = next;
        rate_ *= adam_.decay;
        return true;
      } catch (const NumericsError&) {
        std::fill(mean_.begin(), mean_.end(), 0.0);
      }
    }
    return false;
  }

  Variables moved(const Variables& u, const Variables& step) const {
    Variables next = u;
    for (std::size_t i = 0; i < u.size(); ++i) next[i] += rate_ * step[i];
    return loss_.space().projected(next);
  }

  /// Whether the mean loss of the last iterations differs from that of as many before by less than the tolerance: Adam's inertia makes the
  /// loss itself go up and down.
  bool settled(double loss) {
    constexpr int window = 10;
    if (loss == 0) return true;
    losses_.push_back(loss);
    if (losses_.size() > 2 * window) losses_.pop_front();
    if (!adam_.tolerance || losses_.size() < 2 * window) return false;
    const auto middle = losses_.begin() + window;
    const double before = std::accumulate(losses_.begin(), middle, 0.0), now = std::accumulate(middle, losses_.end(), 0.0);
    return std::abs(before - now) < *adam_.tolerance * before;
  }

  const deck::Adam& adam_;
  LossFunction& loss_;
  double rate_;
  Variables mean_, square_;
  std::deque<double> losses_;
};

}  // namespace

Ending minimise(const deck::Adam& adam, LossFunction& loss) { return Adam(adam, loss).walk(); }

}  // namespace jaxmpm
