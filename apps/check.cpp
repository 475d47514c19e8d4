// jaxmpm check: everything wrong with a deck or, when nothing is, what running it will take.
#include <spdlog/fmt/fmt.h>

#include <iostream>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/provenance.hpp"
#include "core/runtime.hpp"
#include "core/stopwatch.hpp"
#include "inverse/observations.hpp"
#include "inverse/unknowns.hpp"
#include "io/progress.hpp"
#include "io/results_directory.hpp"
#include "observe/gauge.hpp"
#include "scene/advice.hpp"
#include "solvers/simulation.hpp"

namespace jaxmpm {
namespace {

/// Mean cost of a step, s, from a few steps of a state that is thrown away.
double measure_step(Solver& solver, const deck::Time& time) {
  constexpr int most_steps = 50;
  constexpr double long_enough = 2;  // s
  const auto step = [&] { solver.step(time.step ? *time.step : solver.stable_step()); };
  step();  // sorts, allocates
  const Stopwatch watch;
  double seconds = 0;
  int steps = 0;
  while (steps < most_steps && seconds < long_enough) {
    step();
    ++steps;
    seconds = watch.seconds();
  }
  return seconds / steps;
}

void print_bodies(const Model& model, const Solver& solver) {
  std::cout << "particles       " << solver.particle_count() << '\n';
  for (const Body& body : model.bodies) {
    double mass = 0;
    for (const double m : body.initial.mass) mass += m;
    std::cout << "  " << body.name << ": " << body.initial.id.size() << ", " << mass << (model.dim == 2 ? " kg/m" : " kg") << '\n';
  }
}

FirstStep first_step(const Model& model, const Solver& solver) {
  return {model.time.step.value_or(solver.stable_step()), step_limit(model, solver)};
}

/// Whether a fixed step is within the limit of the first state.
bool print_step(const Model& model, const FirstStep& step) {
  const auto [dt, limit] = step;
  std::cout << fmt::format("time step       {:.4g} s ({}; limit of the first state about {:.4g} s)\nsteps           {:.0f}{}\n", dt,
                           model.time.step ? "fixed" : "automatic", limit, model.time.end / dt,
                           model.time.step ? "" : " or more, as the flow gets faster");
  return dt <= limit;
}

/// Single numbers with where their search starts; of more than a screenful the first.
void print_unknowns(const Unknowns& unknowns) {
  constexpr int most = 20;
  int shown = 0;
  for (const VariableBlock& block : unknowns.blocks()) {
    if (block.count > 1 || shown == most) continue;
    ++shown;
    const double start = unknowns.number(block.first, unknowns.space().start[block.first]);
    for (const std::string& pointer : block.pointers) std::cout << fmt::format("unknown         {} from {:.6g}\n", pointer, start);
  }
}

/// What an inversion of the deck looks for, and at. Data that are missing, or of another form of the deck, are no error of the deck.
void print_inversion(const deck::Deck& deck, const Model& model) {
  if (deck.inverse.empty()) return;
  const Unknowns unknowns(deck);
  check_bounds(deck, unknowns);
  print_unknowns(unknowns);
  std::cout << "inversion       " << unknowns.size() << (unknowns.size() == 1 ? " unknown; " : " unknowns; ");
  try {
    const std::vector<double> times = make_observer(deck, model)->times();
    std::cout << fmt::format("data at {} times, the last at {:.4g} s; a gradient takes about as long as four runs\n", times.size(),
                             times.empty() ? 0 : times.back());
  } catch (const Error& error) {
    std::cout << "not to be run yet:\nnote: " << error.what() << '\n';
  }
}

}  // namespace

int check(const DeckOptions& options) {
  const deck::Deck deck = deck::read_deck(options.deck, options.assignments);
  const Runtime runtime(options.threads);
  const Model model = build_model(deck);
  const GaugeSet gauges(deck, model);
  const auto solver = make_solver(model, options.backend ? chosen_backend(options) : Backend::cpu);
  std::cout << options.deck << ": no errors\n";
  print_bodies(model, *solver);
  const FirstStep step = first_step(model, *solver);
  const bool good = print_step(model, step);
  std::cout << fmt::format("memory          {:.3g} GB for particles ({:.0f} bytes each), {:.3g} GB with grid and scene\n",
                           solver->bytes_per_particle() * static_cast<double>(solver->particle_count()) / 1e9, solver->bytes_per_particle(),
                           peak_memory_bytes() / 1e9);
  const double cost = good ? measure_step(*solver, model.time) : 0;
  if (good)
    std::cout << fmt::format("estimated time  {} ({:.3g} s a step on {} threads of this machine, without output)\n",
                             duration(cost * model.time.end / step.dt), cost, thread_count());
  print_inversion(deck, model);
  const ResultsDirectory directory(deck.output.directory);
  std::cout << "results         " << directory.path()
            << (directory.holds_results() ? " (holds results: --overwrite or --resume will be needed)" : "") << '\n';
  for (const std::string& notice : model.notices) std::cout << "note: " << notice << '\n';
  for (const std::string& sentence : advice(deck, model, step)) std::cout << "advice: " << sentence << '\n';
  if (good) return static_cast<int>(ExitCode::done);
  std::cout << "VERDICT: /time/step is above the limit, so the run would become unstable. Lower it, or use \"auto\".\n";
  return static_cast<int>(ExitCode::bad_verdict);
}

}  // namespace jaxmpm
