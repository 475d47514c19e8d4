// jaxmpm gradient: loss and gradient of a deck at the start of its unknowns, and whether the gradient is right.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/logging.hpp"
#include "core/runtime.hpp"
#include "core/signals.hpp"
#include "inverse/gradient_check.hpp"
#include "inverse/run_objective.hpp"

namespace jaxmpm {
namespace {

using Json = nlohmann::ordered_json;

Json gradient_json(const Evaluation& at, const Unknowns& unknowns) {
  Json json{{"loss", at.loss}, {"gradient", Json::object()}};
  for (const std::string& pointer : unknowns.pointers()) {
    const std::vector<double>& numbers = at.gradient.at(pointer);
    json["gradient"][pointer] = deck::is_list(pointer) ? Json(numbers) : Json(numbers.at(0));
  }
  return json;
}

Json check_json(const GradientCheck& check) {
  Json json{
      {"verdict", check.good ? "good" : "bad"}, {"summary", check.verdict}, {"directions", Json::array()}, {"unknowns", Json::object()}};
  for (const DirectionCheck& one : check.directions)
    json["directions"].push_back({{"derivative", one.derivative},
                                  {"difference", one.difference},
                                  {"dot_product", one.dot_product},
                                  {"slope", one.slope},
                                  {"steps", one.step},
                                  {"remainders", one.remainder}});
  for (const VariableCheck& one : check.variables)
    json["unknowns"][one.label] = {{"derivative", one.derivative}, {"difference", one.difference}, {"relative_error", one.error}};
  json["particle_steps"] = check.particle_steps;
  json["particle_steps_at_kinks"] = check.particles_at_kinks;
  return json;
}

void print_gradient(const Evaluation& at, const Unknowns& unknowns) {
  std::cout << fmt::format("loss {:.9e}\n", at.loss);
  for (const std::string& pointer : unknowns.pointers()) {
    const std::vector<double>& numbers = at.gradient.at(pointer);
    double square = 0;
    for (const double g : numbers) square += g * g;
    if (deck::is_list(pointer)) std::cout << fmt::format("{}: {} values, |gradient| {:.9e}\n", pointer, numbers.size(), std::sqrt(square));
    else std::cout << fmt::format("{}  {:.9e}\n", pointer, numbers.at(0));
  }
}

void print_directions(const GradientCheck& check) {
  std::cout << "\nTaylor remainders |L(u + ε d) − L(u) − ε g·d| along random directions d; they fall as ε² where g is right\n      ε   ";
  for (std::size_t k = 0; k < check.directions.size(); ++k) std::cout << fmt::format("  direction {}", k + 1);
  std::cout << '\n';
  const std::size_t steps = check.directions.empty() ? 0 : check.directions[0].step.size();
  for (std::size_t s = 0; s < steps; ++s) {
    std::cout << fmt::format("{:10.2e}", check.directions[0].step[s]);
    for (const DirectionCheck& one : check.directions) std::cout << fmt::format("  {:11.3e}", one.remainder[s]);
    std::cout << '\n';
  }
  const auto line = [&check](const char* name, double DirectionCheck::*member, const char* format) {
    std::cout << fmt::format("{:<10}", name);
    for (const DirectionCheck& one : check.directions) std::cout << fmt::format(fmt::runtime(format), one.*member);
    std::cout << '\n';
  };
  line("slope", &DirectionCheck::slope, "  {:11.3f}");
  std::cout << "\nDerivative along d: g·d by the adjoint, difference of losses, and dot product <J d, r> by differences of residuals\n";
  line("adjoint", &DirectionCheck::derivative, "  {:14.7e}");
  line("difference", &DirectionCheck::difference, "  {:14.7e}");
  line("dot prod.", &DirectionCheck::dot_product, "  {:14.7e}");
}

void print_check(const GradientCheck& check) {
  print_directions(check);
  std::cout << "\nDerivative by each variable (of the transformed number, with priors): adjoint, difference, relative error\n";
  for (const VariableCheck& one : check.variables)
    std::cout << fmt::format("{:<48}  {:14.7e}  {:14.7e}  {:8.1e}\n", one.label, one.derivative, one.difference, one.error);
  const double share =
      check.particle_steps > 0 ? static_cast<double>(check.particles_at_kinks) / static_cast<double>(check.particle_steps) : 0;
  std::cout << fmt::format("\nparticles at kinks: {} of {} particle-steps ({:.2g} %)\nVERDICT: {}\n", check.particles_at_kinks,
                           check.particle_steps, 100 * share, check.verdict);
}

/// A gradient beside that of the same deck in double precision.
struct SinglePrecision {
  static constexpr double most = 1e-2;  // an optimiser goes the same way with it
  static constexpr double near = 1e-3;  // of the variables' scales from a minimum the gradient is rounding, and counts as one from there
  double error;                         // length of the difference over that of the gradient, each variable in its scale
  bool good() const { return error <= most; }
};

SinglePrecision compared(const Unknowns& unknowns, const Evaluation& single, const Evaluation& exact, double curvature) {
  const Variables &u = unknowns.space().start, &scale = unknowns.space().scale;
  const Variables found = unknowns.gradient(u, single.gradient), right = unknowns.gradient(u, exact.gradient);
  double off = 0, size = 0;
  for (std::size_t i = 0; i < u.size(); ++i) off += std::pow(scale[i] * (found[i] - right[i]), 2), size += std::pow(scale[i] * right[i], 2);
  return {std::sqrt(off) / std::max({std::sqrt(size), SinglePrecision::near * curvature, 1e-300})};
}

/// Loss and gradient of a deck at the start of its unknowns.
class Start {
 public:
  Start(const deck::Deck& deck, Backend backend)
      : unknowns(deck), objective(deck, backend, unknowns.pointers(), [] { return stop_signal() != 0; }) {
    const Values values = unknowns.values(unknowns.space().start);
    objective.renew_steps(values);
    at = objective.gradient(values);
  }
  Unknowns unknowns;
  RunObjective objective;
  Evaluation at;
};

/// Differences of losses in single precision are too rough to check a gradient by: the deck is checked in double precision then, and the
/// gradient compared with that one's.
bool check(const GradientOptions& options, const deck::Deck& deck, Start& start, Json& json) {
  std::optional<Start> in_double;
  if (deck.method.precision == deck::Precision::f32)
    in_double.emplace(deck::with_assignments(deck, {"/method/precision=\"f64\""}), chosen_backend(options));
  Start& checked = in_double ? *in_double : start;
  const GradientCheck check = check_gradient(checked.unknowns, checked.objective, options.directions, options.seed);
  json["check"] = check_json(check);
  if (!options.json) print_check(check);
  if (!in_double) return check.good;
  const SinglePrecision single = compared(start.unknowns, start.at, in_double->at, check.curvature);
  json["check"]["single_precision"] = {{"relative_error", single.error}, {"verdict", single.good() ? "good" : "bad"}};
  if (!options.json)
    std::cout << fmt::format("(All that in double precision.) Single precision: the gradient is off by {:.1e} of its length: {}\n",
                             single.error, single.good() ? "good" : "BAD");
  return check.good && single.good();
}

int evaluate(const GradientOptions& options) {
  const deck::Deck deck = deck::read_deck(options.deck, options.assignments);
  Start start(deck, chosen_backend(options));
  Json json = gradient_json(start.at, start.unknowns);
  if (!options.json) print_gradient(start.at, start.unknowns);
  const bool good = !options.check || check(options, deck, start, json);
  if (options.json) std::cout << json.dump() << '\n';
  return static_cast<int>(good ? ExitCode::done : ExitCode::bad_verdict);
}

}  // namespace

int gradient(const GradientOptions& options) {
  watch_signals();
  const Runtime runtime(options.threads);
  try {
    return evaluate(options);
  } catch (const Stopped&) {
    spdlog::info("Stopped; nothing is kept.");
    return static_cast<int>(ExitCode::stopped);
  }
}

}  // namespace jaxmpm
