#include <nlopt.h>

#include <cmath>
#include <exception>
#include <limits>
#include <memory>

#include "core/error.hpp"
#include "inverse/optimizer.hpp"

namespace jaxmpm {
namespace {

/// The first step goes so far, in parts of the variables' scales: the loss is multiplied so that its scaled gradient has this length,
/// because L-BFGS takes the gradient itself for its first step.
constexpr double first_step = 0.1;
/// Unit of the variables that NLopt sees, in parts of their scales. NLopt ends where no component of its gradient exceeds 1e-8 and lets
/// nobody change that: in this unit it is some 1e-12 of the first gradient, while first_step stays what it is. A power of two keeps bounds
/// exact.
constexpr double unit = 1.0 / (1 << 17);
/// A value that no line search accepts, beyond which NLopt halves its step instead of interpolating (its maxf is 1e20).
constexpr double unacceptable = 1e30;
/// Evaluations after which steps that vary are renewed.
constexpr int evaluations_of_a_leg = 20;
/// Evaluations in a row that may pass without a lower loss. A line search takes a handful; beyond that the loss only goes up and down by
/// rounding, as it does early in single precision.
constexpr int most_in_vain = 10;

/// One call of NLopt: from a point, with the steps of its start.
class Leg {
 public:
  Leg(const deck::Lbfgs& settings, LossFunction& loss, Variables start, double factor, int most)
      : loss_(loss), best_(std::move(start)), factor_(factor), left_(most) {
    const SearchSpace& space = loss.space();
    nlopt_.reset(nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(space.size())));
    if (!nlopt_) throw std::bad_alloc();
    nlopt_set_lower_bounds(nlopt_.get(), scaled(space.lower).data());
    nlopt_set_upper_bounds(nlopt_.get(), scaled(space.upper).data());
    nlopt_set_vector_storage(nlopt_.get(), static_cast<unsigned>(settings.memory));
    nlopt_set_ftol_rel(nlopt_.get(), settings.tolerance.value_or(0));
    nlopt_set_min_objective(nlopt_.get(), &Leg::evaluate, this);
  }

  Ending run() {
    Variables w = scaled(best_);
    double value = 0;
    const nlopt_result result = nlopt_optimize(nlopt_.get(), w.data(), &value);
    if (failure_) std::rethrow_exception(failure_);
    if (result == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
    if (in_vain_ == most_in_vain) return Ending::stalled;
    if (result == NLOPT_FORCED_STOP || stopped_) return Ending::iterations;
    return result > 0 ? Ending::converged : Ending::stalled;
  }

  const Variables& best() const { return best_; }
  double factor() const { return factor_; }
  int left() const { return left_; }
  double first_loss() const { return first_loss_; }
  double best_loss() const { return best_loss_; }

 private:
  Variables scaled(const Variables& u) const {
    Variables w(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) w[i] = u[i] / (unit * loss_.space().scale[i]);
    return w;
  }

  /// NLopt is C: nothing may be thrown through it.
  static double evaluate(unsigned n, const double* w, double* gradient, void* leg) {
    Leg& self = *static_cast<Leg*>(leg);
    std::fill(gradient, gradient + n, 0.0);
    try {
      if (!self.failure_ && self.left_ > 0 && self.in_vain_ < most_in_vain) return self.evaluate(Variables(w, w + n), gradient);
      self.stopped_ = true;
    } catch (const NumericsError&) {
      if (!self.started_) self.failure_ = std::current_exception();
    } catch (...) {
      self.failure_ = std::current_exception();
    }
    if (self.failure_ || self.stopped_) nlopt_force_stop(self.nlopt_.get());
    return unacceptable;
  }

  double evaluate(Variables u, double* gradient) {
    const SearchSpace& space = loss_.space();
    for (std::size_t i = 0; i < u.size(); ++i) u[i] *= unit * space.scale[i];
    u = space.projected(std::move(u));  // scaling there and back may lead out of a bound by rounding
    --left_;
    ++in_vain_;
    const LossFunction::Sample sample = loss_.gradient(u);
    for (std::size_t i = 0; i < u.size(); ++i) gradient[i] = sample.gradient[i] * unit * space.scale[i];
    if (factor_ == 0) {
      double square = 0;
      for (std::size_t i = 0; i < u.size(); ++i) square += gradient[i] * gradient[i];
      factor_ = square > 0 ? first_step / (unit * std::sqrt(square)) : 1;
    }
    for (std::size_t i = 0; i < u.size(); ++i) gradient[i] *= factor_;
    if (!started_) first_loss_ = sample.loss;
    if (!started_ || sample.loss < best_loss_) {
      best_ = std::move(u);
      best_loss_ = sample.loss;
      in_vain_ = 0;
    }
    started_ = true;
    return factor_ * sample.loss;
  }

  struct Destroy {
    void operator()(nlopt_opt opt) const { nlopt_destroy(opt); }
  };
  LossFunction& loss_;
  std::unique_ptr<std::remove_pointer_t<nlopt_opt>, Destroy> nlopt_;
  Variables best_;
  double factor_;    // on the loss; 0: to be chosen
  int left_;         // evaluations
  int in_vain_ = 0;  // evaluations since the last lower loss
  double first_loss_ = 0, best_loss_ = 0;
  bool started_ = false, stopped_ = false;
  std::exception_ptr failure_;
};

}  // namespace

Ending minimise(const deck::Lbfgs& lbfgs, LossFunction& loss) {
  Variables u = loss.space().start;
  double factor = 0;
  for (int left = lbfgs.iterations; left > 0;) {
    loss.renew_steps(u);
    const int most = loss.steps_vary() ? std::min(left, evaluations_of_a_leg) : left;
    Leg leg(lbfgs, loss, u, factor, most);
    const Ending ending = leg.run();
    left -= most - leg.left();
    u = leg.best();
    factor = leg.factor();
    if (!loss.steps_vary()) return ending;
    // With steps that vary, an end counts once renewing them changes nothing any more.
    constexpr double rounding = 1e-12;
    const bool same = leg.first_loss() - leg.best_loss() <= lbfgs.tolerance.value_or(rounding) * leg.first_loss();
    if (ending != Ending::iterations && same) return ending;
  }
  return Ending::iterations;
}

}  // namespace jaxmpm
