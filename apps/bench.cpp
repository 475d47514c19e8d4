// jaxmpm bench: the cost of steps alone, without output, after a warm-up; and of a gradient over as many.
#include <algorithm>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/runtime.hpp"
#include "core/stopwatch.hpp"
#include "inverse/differentiated_run.hpp"
#include "inverse/run_objective.hpp"
#include "io/summary.hpp"

namespace jaxmpm {
namespace {

/// Takes steps as a run would, but never to an end; returns their lengths, s.
std::vector<double> take(Solver& solver, const deck::Time& time, std::uint64_t steps, std::size_t& most_blocks) {
  std::vector<double> taken(steps);
  for (double& dt : taken) {
    dt = time.step ? *time.step : solver.stable_step();
    solver.step(dt);
    most_blocks = std::max(most_blocks, solver.active_blocks());
  }
  return taken;
}

/// Half the sum of squares of all final coordinates: a loss that needs the whole run and costs next to nothing itself.
class FinalPositions : public Observer {
 public:
  explicit FinalPositions(double end) : times_{end} {}
  const std::vector<double>& times() const override { return times_; }
  FieldSelection needs() const override { return {}; }
  void look(std::size_t, const Moment&, const std::vector<BodySnapshot>& bodies) override {
    seen_.assign(bodies.size(), {});
    residuals_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      seen_[b].position = bodies[b].position;
      residuals_.insert(residuals_.end(), bodies[b].position.begin(), bodies[b].position.end());
    }
  }
  double loss() const override {
    double sum = 0;
    for (const double x : residuals_) sum += x * x;
    return sum / 2;
  }
  const std::vector<double>& residuals() const override { return residuals_; }
  SnapshotGradient gradient(std::size_t) const override { return seen_; }

 private:
  std::vector<double> times_, residuals_;
  SnapshotGradient seen_;
};

/// The gradient of the first `dt.size()` steps, within the deck's memory and disk: the second of two, as most of an inversion's, since the
/// first one also pays for memory that no one has touched before.
nlohmann::ordered_json bench_gradient(const Model& model, Backend backend, const deck::Deck& deck, std::vector<double> dt,
                                      std::size_t blocks, std::uint64_t sorts, double plain_seconds) {
  double end = 0;
  for (const double step : dt) end += step;
  FinalPositions observer(end);
  const StepSequence steps{dt, {dt.size()}, blocks, sorts, {}};
  SnapshotStack snapshots(make_state_memory(backend), deck.output.directory);
  const Room room = room_of(deck.inverse.empty() ? deck::Inverse{} : deck::inverse_of(deck));
  const MemoryPlan plan = plan_gradient(model, steps, room, snapshots);
  RunCost first, cost;
  differentiate_run(model, steps, observer, plan, snapshots, first, {});
  differentiate_run(model, steps, observer, plan, snapshots, cost, {});
  const double seconds = cost.forward_seconds + cost.reverse_seconds;
  return {{"forward_seconds", cost.forward_seconds},
          {"reverse_seconds", cost.reverse_seconds},
          {"seconds_per_1000_steps", 1000 * seconds / static_cast<double>(dt.size())},
          {"times_plain_run", seconds / plain_seconds},
          {"first_seconds", first.forward_seconds + first.reverse_seconds},
          {"snapshots", plan.snapshots},
          {"recomputed_steps", plan.recomputed_steps},
          {"predicted_peak_bytes", plan.peak_bytes},
          {"measured_peak_bytes", cost.measured_peak_bytes},
          {"snapshots_on_disk", plan.on_disk},
          {"disk_bytes", plan.disk_bytes},
          {"written_bytes", cost.written_bytes},
          {"read_bytes", cost.read_bytes}};
}

PhaseSeconds operator-(const PhaseSeconds& a, const PhaseSeconds& b) {
  return {a.sort - b.sort, a.p2g - b.p2g, a.grid - b.grid, a.g2p - b.g2p};
}

nlohmann::ordered_json measure(const BenchOptions& options) {
  const Runtime runtime(options.threads);
  const deck::Deck deck = deck::read_deck(options.deck, options.assignments);
  Model model = build_model(deck);
  const Backend backend = chosen_backend(options);
  auto solver = make_solver(model, backend);
  if (!options.gradient)
    for (Body& body : model.bodies) body.initial = {};
  std::size_t most_blocks = 0;
  std::vector<double> dt = take(*solver, model.time, options.warm_up, most_blocks);
  const PhaseSeconds before = solver->phase_seconds();
  const double cpu_before = processor_seconds();
  const Stopwatch watch;
  const std::vector<double> measured = take(*solver, model.time, options.steps, most_blocks);
  const double seconds = watch.seconds();
  const double cpu = processor_seconds() - cpu_before;
  nlohmann::ordered_json result = cost_summary(model, *solver, backend, options.steps, seconds, solver->phase_seconds() - before);
  result["cpu_seconds"] = cpu;
  if (!options.gradient) return result;
  const std::uint64_t sorts = solver->sorts();
  solver.reset();
  dt.insert(dt.end(), measured.begin(), measured.end());
  dt.resize(options.steps);
  result["gradient"] = bench_gradient(model, backend, deck, std::move(dt), most_blocks, sorts, seconds);
  return result;
}

}  // namespace

int bench(const BenchOptions& options) {
  const nlohmann::ordered_json result = measure(options);
  if (options.json) std::cout << result.dump() << '\n';
  else
    for (const auto& [key, value] : result.items()) std::cout << key << ": " << value.dump() << '\n';
  return 0;
}

}  // namespace jaxmpm
