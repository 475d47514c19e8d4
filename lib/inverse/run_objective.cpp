#include "inverse/run_objective.hpp"

#include <spdlog/spdlog.h>

#include <cmath>

#include "core/error.hpp"
#include "core/stopwatch.hpp"
#include "inverse/observations.hpp"
#include "inverse/scene_gradient.hpp"
#include "io/summary.hpp"

namespace jaxmpm {
namespace {

/// Bytes of an amount as the deck gives it: "4 GiB".
std::size_t bytes_of(const std::string& amount) {
  std::size_t end = 0;
  const double number = std::stod(amount, &end);
  const std::string unit = amount.substr(amount.find_first_not_of(' ', end));
  return static_cast<std::size_t>(std::ldexp(number, unit == "MiB" ? 20 : unit == "GiB" ? 30 : 40));
}

constexpr double mib = 1 << 20;

}  // namespace

Room room_of(const deck::Inverse& inverse) { return {bytes_of(inverse.memory), inverse.disk == "none" ? 0 : bytes_of(inverse.disk)}; }

RunObjective::RunObjective(const deck::Deck& deck, Backend backend, std::vector<std::string> pointers, std::function<bool()> stop)
    : deck_(with_values(deck, {})),
      backend_(backend),
      pointers_(std::move(pointers)),
      room_(room_of(deck::inverse_of(deck))),
      stop_(std::move(stop)),
      snapshots_(make_state_memory(backend), deck.output.directory) {
  const Model model = build_model(deck);
  for (const std::string& notice : model.notices) spdlog::info("Note: {}", notice);
  observer_ = make_observer(deck, model);
}

Evaluation RunObjective::loss(const Values& values) {
  const Model model = build_model(with_values(deck_, values), values);
  const Stopwatch watch;
  replay_run(model, backend_, steps_, *observer_, stop_);
  Evaluation found;
  found.loss = observer_->loss();
  found.forward_seconds = watch.seconds();
  return found;
}

Evaluation RunObjective::gradient(const Values& values) {
  const deck::Deck deck = with_values(deck_, values);
  const Model model = build_model(deck, values);
  const MemoryPlan plan = plan_gradient(model, steps_, room_, snapshots_);
  if (!told_) tell_plan(plan);
  RunCost cost;
  const ModelGradient by_model = differentiate_run(model, steps_, *observer_, plan, snapshots_, cost, stop_);
  if (!told_ && plan.on_disk > 0) tell_disk(cost);
  told_ = true;
  const Stopwatch watch;
  Evaluation found;
  found.loss = observer_->loss();
  found.gradient = gradient_by_pointer(deck, model, by_model, pointers_);
  found.forward_seconds = cost.forward_seconds;
  found.gradient_seconds = cost.reverse_seconds + watch.seconds();
  found.peak_bytes = cost.measured_peak_bytes;
  found.particles_at_kinks = cost.particles_at_kinks;
  for (const Body& body : model.bodies) found.particle_steps += body.initial.id.size() * steps_.dt.size();
  return found;
}

void RunObjective::renew_steps(const Values& values) {
  if (!steps_vary() && !steps_.dt.empty()) return;
  const Model model = build_model(with_values(deck_, values), values);
  const std::size_t before = steps_.dt.size();
  if (before == 0 && model.time.step)  // an automatic step is never too long
    if (const std::string warning = large_step_warning(model, *make_solver(model, backend_)); !warning.empty()) spdlog::warn(warning);
  steps_ = record_run(model, backend_, *observer_, stop_);
  if (before == 0 && !steps_.note.empty()) spdlog::info("Note: with the first values, {}", steps_.note);
  if (before > 0 && steps_.dt.size() != before) spdlog::info("Time steps renewed: {}, before {}.", steps_.dt.size(), before);
}

bool RunObjective::admits(const Values& values) const {
  try {
    with_values(deck_, values);
    return true;
  } catch (const DeckError&) {
    return false;
  }
}

std::string RunObjective::backend() const { return backend_name(backend_); }

void RunObjective::tell_plan(const MemoryPlan& plan) const {
  const std::string disk =
      plan.on_disk > 0 ? fmt::format(", {} of them on disk ({:.4g} MiB)", plan.on_disk, static_cast<double>(plan.disk_bytes) / mib) : "";
  spdlog::info(
      "Gradient of {} steps: {} snapshots of {:.3g} MiB kept at once{}, {:.3g} steps computed again; predicted peak {:.4g} MiB of {:.4g} "
      "MiB.",
      plan.steps, plan.snapshots, static_cast<double>(plan.snapshot_bytes) / mib, disk, plan.recomputed_steps,
      static_cast<double>(plan.peak_bytes) / mib, static_cast<double>(room_.memory) / mib);
}

void RunObjective::tell_disk(const RunCost& cost) const {
  spdlog::info("Snapshots on disk: {:.4g} MiB written, {:.4g} MiB read.", static_cast<double>(cost.written_bytes) / mib,
               static_cast<double>(cost.read_bytes) / mib);
}

}  // namespace jaxmpm
