#include "inverse/gradient_check.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "fields/random.hpp"
#include "inverse/differences.hpp"
#include "inverse/linear_algebra.hpp"
#include "inverse/recorded_loss.hpp"

namespace jaxmpm {
namespace {

constexpr double largest_step = 0.1;
constexpr int steps_a_decade = 2, decades = 5, decades_of_slope = 3;
constexpr double slope_tolerance = 0.1;
constexpr double rounding = 1e-13;           // of the loss and of its change, in a remainder
constexpr double smooth_agreement = 1e-5;    // of differences with the adjoint, relative
constexpr double branched_agreement = 1e-3;  // the same where the runs to either side cross branches
constexpr double most_scatter = 1e-2;        // the same at most, where differences of finer and finer steps do not agree with each other
constexpr double at_minimum = 1e-6;          // parts of the variables' scales
constexpr double finest[] = {1e-6, 1e-7, 1e-8};  // where differences over larger steps do not agree with the adjoint
constexpr std::size_t most_variables = 20;

double nearer(double a, double b, double target) { return std::abs(a - target) <= std::abs(b - target) ? a : b; }

/// How far differences over finer and finer steps (three at least) still differ from each other. A node that particles reach anew at a free
/// surface gives them a small jump of the velocity gradient, so that differences scatter about a right derivative even where no branch
/// changes.
double scatter(const std::vector<double>& differences) {
  double most = 0;
  for (std::size_t k = differences.size() - 2; k < differences.size(); ++k)
    most = std::max(most, std::abs(differences[k] - differences[k - 1]));
  return most;
}

double relative_error(double value, double expected, double least) {
  return std::abs(value - expected) / std::max({std::abs(value), std::abs(expected), least});
}

class Check {
 public:
  Check(const Unknowns& unknowns, Objective& objective, std::uint64_t seed)
      : unknowns_(unknowns), objective_(objective), seed_(seed), u_(unknowns.space().start) {
    const Values values = unknowns.values(u_);
    objective.renew_steps(values);
    const Evaluation at = objective.gradient(values);
    result_.particle_steps = at.particle_steps;
    result_.particles_at_kinks = at.particles_at_kinks;
    residuals_ = with_priors(objective.residuals(), u_);
    gradient_ = unknowns.gradient(u_, at.gradient);
    unknowns.add_prior_gradient(u_, gradient_);
    result_.loss = loss_at(u_);  // by a plain run, as all that it is compared with
  }

  GradientCheck run(std::size_t directions) {
    for (std::size_t k = 0; k < directions; ++k) result_.directions.push_back(check_direction(direction(k)));
    for (const std::size_t i : chosen_variables()) result_.variables.push_back(check_variable(i));
    result_.curvature = curvature_;
    judge();
    return std::move(result_);
  }

 private:
  std::vector<double> with_priors(std::vector<double> residuals, const Variables& u) const {
    const Variables prior = unknowns_.prior_residuals(u);
    residuals.insert(residuals.end(), prior.begin(), prior.end());
    return residuals;
  }
  std::vector<double> residuals_at(const Variables& u) {
    objective_.loss(unknowns_.values(u));
    return with_priors(objective_.residuals(), u);
  }
  double loss_at(const Variables& u) {
    const std::vector<double> r = residuals_at(u);
    return dot(r, r) / 2;
  }
  Variables moved(const Variables& d, double step) const {
    Variables u = u_;
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += step * d[i];
    return u;
  }
  bool allowed(const Variables& u) const { return unknowns_.space().projected(u) == u && objective_.admits(unknowns_.values(u)); }

  /// A component that leads out of what is allowed is turned round; where neither way is open it is shortened.
  Variables direction(std::size_t index) const {
    RandomStream random(seed_, index);
    Variables d(u_.size(), 0.0);
    for (std::size_t i = 0; i < d.size(); ++i) {
      double component = random.normal() * unknowns_.space().scale[i];
      for (int turn = 0; turn < 20; ++turn, component *= turn % 2 == 1 ? -1 : 0.5) {
        Variables along(u_.size(), 0.0);
        along[i] = component;
        if (!allowed(moved(along, 2 * largest_step))) continue;
        d[i] = component;
        break;
      }
    }
    return d;
  }

  DirectionCheck check_direction(const Variables& d) {
    DirectionCheck check;
    check.derivative = check.difference = dot(gradient_, d);
    for (std::size_t i = 0; i < d.size(); ++i) check.size += gradient_[i] * d[i] * gradient_[i] * d[i];
    check.size = std::sqrt(check.size);
    const std::size_t count = steps_a_decade * decades + 1;
    std::vector<bool> above_rounding;
    double closest = HUGE_VAL;
    std::vector<double> differences;
    for (std::size_t k = 0; k < count; ++k) {
      const double step = largest_step * std::pow(10.0, -static_cast<double>(k) / steps_a_decade);
      const std::vector<double> ahead = residuals_at(moved(d, step));
      const double loss = dot(ahead, ahead) / 2, change = step * check.derivative;
      check.step.push_back(step);
      check.remainder.push_back(std::abs(loss - result_.loss - change));
      above_rounding.push_back(check.remainder.back() > 10 * rounding * (std::abs(loss) + std::abs(change)));
      if (k % steps_a_decade == 0 && k > 0) closest = difference_along(d, step, ahead, closest, check, differences);
    }
    check_finer_along(d, closest, check, differences);
    // At a minimum the derivative is nothing but rounding: it counts as one where it is what a millionth of d away from it would be.
    const double curvature = 2 * check.remainder[0] / (largest_step * largest_step);
    check.size = std::max({check.size, at_minimum * curvature, 1e-300});
    curvature_ = std::max(curvature_, curvature);
    check.scatter = scatter(differences);
    judge_slope(check, above_rounding);
    return check;
  }

  /// Differences over still finer steps where none agrees so far: where the loss jumps within the others, only these know its slope.
  void check_finer_along(const Variables& d, double closest, DirectionCheck& check, std::vector<double>& differences) {
    const double size = std::max(check.size, 1e-300);
    const auto error = [&](double value) { return relative_error(value, check.derivative, size); };
    for (const double step : finest) {
      if (std::max(error(check.difference), error(check.dot_product)) <= sure(scatter(differences) / size) ||
          drowned(step * check.derivative))
        return;
      const double before = closest;
      closest = difference_along(d, step, residuals_at(moved(d, step)), closest, check, differences);
      check.fine = check.fine || closest < before;
    }
  }

  /// Up to which error finer differences are not worth a run.
  static double sure(double scatter) { return std::min(agreement(true, scatter), branched_agreement); }

  /// Whether rounding would hide a thousandth of a change of the loss.
  bool drowned(double change) const { return rounding * result_.loss > branched_agreement * std::abs(change); }

  /// (−3 f(0) + 4 f(ε) − f(2ε))/(2ε) or, where the way back is open, (f(ε) − f(−ε))/(2ε), of the residuals; keeps the nearest.
  double difference_along(const Variables& d, double step, const std::vector<double>& ahead, double closest, DirectionCheck& check,
                          std::vector<double>& differences) {
    const bool central = allowed(moved(d, -step));
    const std::vector<double> other = residuals_at(moved(d, central ? -step : 2 * step));
    double product = 0;
    for (std::size_t m = 0; m < ahead.size(); ++m)
      product += residuals_[m] * (central ? ahead[m] - other[m] : 4 * ahead[m] - other[m] - 3 * residuals_[m]) / (2 * step);
    const double here = dot(residuals_, residuals_) / 2, front = dot(ahead, ahead) / 2, beside = dot(other, other) / 2;
    const double difference = (central ? front - beside : 4 * front - beside - 3 * here) / (2 * step);
    differences.push_back(difference);
    const double miss = std::abs(difference - check.derivative) + std::abs(product - check.derivative);
    if (!(miss < closest)) return closest;
    check.difference = difference;
    check.dot_product = product;
    return miss;
  }

  /// Least-squares slope over every three decades above rounding; fewer of them are taken where rounding begins early.
  static void judge_slope(DirectionCheck& check, const std::vector<bool>& above_rounding) {
    std::size_t usable = 0;
    while (usable < above_rounding.size() && above_rounding[usable]) ++usable;
    constexpr std::size_t whole = steps_a_decade * decades_of_slope + 1, least = steps_a_decade + 1;
    if (usable < least) {
      check.smooth = true;  // the loss is as good as linear along d
      return;
    }
    const std::size_t window = std::min(whole, usable);
    for (std::size_t first = 0; first + window <= usable; ++first) {
      double x = 0, y = 0, xx = 0, xy = 0;
      for (std::size_t k = first; k < first + window; ++k) {
        const double a = std::log(check.step[k]), b = std::log(check.remainder[k]);
        x += a, y += b, xx += a * a, xy += a * b;
      }
      const auto n = static_cast<double>(window);
      check.slope = nearer((n * xy - x * y) / (n * xx - x * x), check.slope, 2);
    }
    check.smooth = std::abs(check.slope - 2) <= slope_tolerance;
  }

  std::vector<std::size_t> chosen_variables() const {
    std::vector<std::size_t> all(u_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    RandomStream random(seed_);
    for (std::size_t i = 0; all.size() > most_variables && i < most_variables; ++i)
      std::swap(all[i], all[i + static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size() - i))]);
    all.resize(std::min(all.size(), most_variables));
    std::sort(all.begin(), all.end());
    return all;
  }

  VariableCheck check_variable(std::size_t i) {
    VariableCheck check{unknowns_.label(i), gradient_[i], HUGE_VAL, 0, 0, false};
    std::vector<double> differences;
    const double scale = unknowns_.space().scale[i];
    double largest = 0;
    for (std::size_t k = 0; k < u_.size(); ++k) largest = std::max(largest, std::abs(gradient_[k]) * unknowns_.space().scale[k]);
    const double least = std::max({1e-3 * largest / scale, at_minimum * curvature_ / scale, 1e-300});
    const auto compare = [&](double spacing) {
      differences.push_back(difference_by(i, spacing * scale));
      check.difference = nearer(differences.back(), check.difference, check.derivative);
      check.error = relative_error(check.difference, check.derivative, least);
    };
    for (const double spacing : {1e-3, 1e-4, 1e-5}) compare(spacing);
    const auto scattered = [&] { return scatter(differences) / std::max(std::abs(check.derivative), least); };
    for (const double spacing : finest) {
      if (check.error <= sure(scattered()) || drowned(spacing * scale * check.derivative)) break;
      const double before = check.error;
      compare(spacing);
      check.fine = check.fine || check.error < before;
    }
    check.scatter = scattered();
    return check;
  }

  double difference_by(std::size_t i, double spacing) {
    const Difference rule = difference(unknowns_, objective_, u_, i, spacing);
    double slope = 0;
    for (std::size_t k = 0; k < rule.offset.size(); ++k) {
      Variables u = u_;
      u[i] += rule.offset[k];
      slope += rule.weight[k] * (rule.offset[k] == 0 ? result_.loss : loss_at(u));
    }
    return slope;
  }

  /// What a relative error may be: as small as the differences are sure.
  static double agreement(bool smooth, double scatter) {
    return smooth ? std::clamp(scatter, smooth_agreement, most_scatter) : branched_agreement;
  }

  void judge() {
    std::size_t rough = 0, wrong = 0, fine = 0;
    for (const DirectionCheck& one : result_.directions) rough += !one.smooth;
    const auto count = [&](bool right, bool by_finest) { wrong += !right, fine += right && by_finest; };
    for (const DirectionCheck& one : result_.directions) {
      const double by_loss = relative_error(one.difference, one.derivative, one.size);
      const double by_residuals = relative_error(one.dot_product, one.derivative, one.size);
      count(std::max(by_loss, by_residuals) <= agreement(one.smooth, one.scatter / one.size), one.fine);
    }
    for (const VariableCheck& one : result_.variables) count(one.error <= agreement(rough == 0, one.scatter), one.fine);
    result_.good = wrong == 0;
    result_.verdict = fmt::format("{}: {} of {} directions have Taylor remainders of second order", result_.good ? "good" : "BAD",
                                  result_.directions.size() - rough, result_.directions.size());
    if (fine > 0)
      result_.verdict += fmt::format("; {} agree with differences over the finest steps only, as the loss jumps within larger ones", fine);
    if (wrong > 0) result_.verdict += fmt::format("; {} derivatives are not those of the runs", wrong);
    if (rough > 0)
      result_.verdict +=
          "; along the others the runs cross branches (contact, yielding, cut-offs), and the gradient is that of the one taken";
  }

  const Unknowns& unknowns_;
  Objective& objective_;
  std::uint64_t seed_;
  Variables u_, gradient_;
  std::vector<double> residuals_;
  double curvature_ = 0;  // the largest of the loss along the directions
  GradientCheck result_;
};

}  // namespace

GradientCheck check_gradient(const Unknowns& unknowns, Objective& objective, std::size_t directions, std::uint64_t seed) {
  return Check(unknowns, objective, seed).run(directions);
}

}  // namespace jaxmpm
