// jaxmpm bench: the cost of steps alone, without output, after a warm-up.
#include <chrono>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "core/runtime.hpp"
#include "io/summary.hpp"

namespace jaxmpm {
namespace {

struct BenchOptions : DeckOptions {
  std::uint64_t steps = 0, warm_up = 0;
  bool json = false;
};

/// Takes steps as a run would, but never to an end.
void take(Solver& solver, const deck::Time& time, std::uint64_t steps) {
  for (std::uint64_t n = 0; n < steps; ++n) solver.step(time.step ? *time.step : solver.stable_step());
}

PhaseSeconds operator-(const PhaseSeconds& a, const PhaseSeconds& b) {
  return {a.sort - b.sort, a.p2g - b.p2g, a.grid - b.grid, a.g2p - b.g2p};
}

nlohmann::ordered_json bench(const BenchOptions& options) {
  const Runtime runtime(options.threads);
  Model model = build_model(deck::read_deck(options.deck, options.assignments));
  const Backend backend = chosen_backend(options);
  const auto solver = make_solver(model, backend);
  for (Body& body : model.bodies) body.initial = {};
  take(*solver, model.time, options.warm_up);
  const PhaseSeconds before = solver->phase_seconds();
  const auto begin = std::chrono::steady_clock::now();
  take(*solver, model.time, options.steps);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return cost_summary(model, *solver, backend, options.steps, seconds, solver->phase_seconds() - before);
}

}  // namespace

void add_bench(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("bench", "Measure the cost of steps, without output");
  auto options = std::make_shared<BenchOptions>();
  add_deck_options(*command, *options);
  add_backend_option(*command, *options);
  command->add_option("--steps", options->steps, "Steps to measure")
      ->required()
      ->check(CLI::Range(std::uint64_t(1), std::uint64_t(1) << 40))
      ->type_name("N");
  options->warm_up = 5;
  command->add_option("--warm-up", options->warm_up, "Steps before that, not counted")->capture_default_str()->type_name("N");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([&chosen, options] {
    chosen = [options](const CommonOptions&) {
      const nlohmann::ordered_json result = bench(*options);
      if (options->json) std::cout << result.dump() << '\n';
      else
        for (const auto& [key, value] : result.items()) std::cout << key << ": " << value.dump() << '\n';
      return 0;
    };
  });
}

}  // namespace jaxmpm
