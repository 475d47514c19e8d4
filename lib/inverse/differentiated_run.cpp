#include "inverse/differentiated_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.hpp"
#include "core/provenance.hpp"
#include "inverse/checkpoint_schedule.hpp"
#include "solvers/reversible.hpp"
#include "spdlog/fmt/fmt.h"

namespace jaxmpm {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

void ask(const std::function<bool()>& stop) {
  if (stop && stop()) throw Stopped{};
}

/// A forward run over a known sequence of steps that shows each state once to the observer.
class Walk {
 public:
  Walk(Solver& solver, const StepSequence& steps, Observer& observer, const std::function<bool()>& stop)
      : solver_(solver), steps_(steps), observer_(observer), stop_(stop), time_(steps.dt.size() + 1, 0.0) {
    for (std::size_t k = 0; k < steps.dt.size(); ++k) time_[k + 1] = time_[k] + steps.dt[k];
    look(0);
  }
  /// From state `from`, which is the present one, to state `to`.
  void advance(std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      ask(stop_);
      solver_.step(steps_.dt[k]);
      look(k + 1);
    }
  }

 private:
  void look(std::size_t state) {
    for (; next_look_ < steps_.looks.size() && steps_.looks[next_look_] == state; ++next_look_) {
      const Moment now{state, time_[state], state > 0 ? steps_.dt[state - 1] : 0, state > 0 ? time_[state - 1] : 0};
      observer_.look(next_look_, now, solver_.snapshot(observer_.needs(), true));
    }
  }

  Solver& solver_;
  const StepSequence& steps_;
  Observer& observer_;
  const std::function<bool()>& stop_;
  std::vector<double> time_;
  std::size_t next_look_ = 0;
};

/// The reverse run: a stack of kept states, the newest below the step that is reversed next.
class Reversal {
 public:
  Reversal(ReversibleSolver& solver, const StepSequence& steps, Observer& observer, std::size_t snapshots, SnapshotPool& pool,
           const std::function<bool()>& stop)
      : solver_(solver),
        steps_(steps),
        observer_(observer),
        stop_(stop),
        walk_(solver.forward(), steps, observer, stop),
        snapshots_(snapshots),
        pool_(pool) {
    pool_.prepare(solver.kept_bytes(), snapshots);
    keep(0);
  }
  ~Reversal() {
    while (!kept_.empty()) forget();
  }

  ModelGradient run(RunCost& cost) {
    const Clock::time_point begin = Clock::now();
    if (steps_.dt.empty()) start_reverse(0);
    for (std::size_t end = steps_.dt.size(); end > 0;) {
      ask(stop_);
      const std::size_t start = kept_.back().state;
      if (end - start > 1) {
        go_to(start);
        const std::size_t next = start + steps_to_next_snapshot(end - start, snapshots_ - kept_.size());
        walk_.advance(start, next);
        keep(next);
        continue;
      }
      if (end == steps_.dt.size()) {
        go_to(start), walk_.advance(start, end);
        cost.forward_seconds = since(begin);
        start_reverse(end);
      }
      reverse_step(start);
      end = start;
    }
    cost.reverse_seconds = since(begin) - cost.forward_seconds;
    cost.particles_at_kinks = solver_.at_kinks();
    return solver_.gradient();
  }

 private:
  struct Snapshot {
    std::size_t state;
    std::byte* numbers;
    std::unique_ptr<KeptState> rest;
  };
  static constexpr std::size_t lost = ~std::size_t(0);

  void keep(std::size_t state) {
    kept_.push_back({state, pool_.take(), nullptr});
    kept_.back().rest = solver_.keep(kept_.back().numbers);
    present_ = state;
  }
  void forget() {
    pool_.give_back(kept_.back().numbers);
    kept_.pop_back();
  }
  void go_back() { solver_.go_back(*kept_.back().rest, kept_.back().numbers); }
  void go_to(std::size_t state) {
    if (present_ != state) go_back();
    present_ = lost;  // it is about to move on
  }
  void start_reverse(std::size_t end) {
    solver_.start_reverse();
    add_looks(end);
  }
  /// Reverses the step from the newest kept state, and forgets that.
  void reverse_step(std::size_t start) {
    go_to(start);
    solver_.step_adjoint(steps_.dt[start]);
    if (start == 0 || looked_at(start)) {
      go_back();
      add_looks(start);
    }
    present_ = lost;
    forget();
  }
  bool looked_at(std::size_t state) const { return std::binary_search(steps_.looks.begin(), steps_.looks.end(), state); }
  void add_looks(std::size_t state) {
    const auto range = std::equal_range(steps_.looks.begin(), steps_.looks.end(), state);
    for (auto at = range.second; at != range.first;) solver_.add_gradient(observer_.gradient(std::size_t(--at - steps_.looks.begin())));
  }

  ReversibleSolver& solver_;
  const StepSequence& steps_;
  Observer& observer_;
  const std::function<bool()>& stop_;
  Walk walk_;
  std::size_t snapshots_, present_ = 0;
  SnapshotPool& pool_;
  std::vector<Snapshot> kept_;
};

/// The next moment of a run that also meets the observer's times.
Moment next_moment(const TimeControl& control, const Moment& now, double stable, double look) {
  const Moment free = control.after_next(now, stable);
  constexpr double sliver = 1e-9;  // of a step: no rest that small is left over
  if (!control.is_automatic() || free.time + sliver * free.dt < look) return free;
  return {now.step + 1, look, look - now.time, now.time};
}

}  // namespace

StepSequence record_run(const Model& model, Observer& observer, const std::function<bool()>& stop) {
  const std::unique_ptr<ReversibleSolver> reversible = make_reversible_solver(model);
  Solver& solver = reversible->forward();
  const TimeControl control(model.time);
  const std::vector<double>& times = observer.times();
  StepSequence steps;
  Moment now;
  for (std::size_t k = 0; k < times.size();) {
    const bool here =
        control.is_automatic() ? now.time >= times[k] : now.step >= std::uint64_t(std::llround(times[k] / control.fixed_step()));
    if (here) {
      observer.look(k++, now, solver.snapshot(observer.needs(), true));
      steps.looks.push_back(now.step);
      continue;
    }
    ask(stop);
    now = next_moment(control, now, control.is_automatic() ? solver.stable_step() : 0, times[k]);
    solver.step(now.dt);
    steps.dt.push_back(now.dt);
  }
  return steps;
}

void replay_run(const Model& model, const StepSequence& steps, Observer& observer, const std::function<bool()>& stop) {
  const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model);
  Walk(solver->forward(), steps, observer, stop).advance(0, steps.dt.size());
}

MemoryPlan plan_gradient(const Model& model, const StepSequence& steps, std::size_t memory_bytes, const SnapshotPool& pool) {
  const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model);
  MemoryPlan plan;
  plan.steps = steps.dt.size();
  plan.snapshot_bytes = solver->kept_bytes() + solver->shared_bytes();
  // Besides snapshots: the program as it stands (with this stepper in it, less the pool's memory), and the derivatives, as large as a
  // state.
  const std::size_t resident = resident_bytes();
  const std::size_t fixed = resident - std::min(pool.bytes(), resident) + 2 * plan.snapshot_bytes;
  const std::size_t fitting = memory_bytes > fixed ? (memory_bytes - fixed) / plan.snapshot_bytes : 0;
  constexpr std::size_t least = 2;
  if (fitting < least && plan.steps > 1)
    throw Error(ExitCode::deck,
                fmt::format("/inverse/memory: {:.1f} MiB are too few: a reverse run of this scene takes {:.1f} MiB and at least "
                            "{} snapshots of {:.2f} MiB; give it {:.0f} MiB or more",
                            double(memory_bytes) / 1048576, double(fixed) / 1048576, least, double(plan.snapshot_bytes) / 1048576,
                            std::ceil(double(fixed + least * plan.snapshot_bytes) / 1048576)));
  plan.snapshots = std::min(std::max(fitting, least), std::max<std::size_t>(plan.steps, 1));
  plan.peak_bytes = fixed + plan.snapshots * plan.snapshot_bytes;
  plan.recomputed_steps = plan.steps > 1 ? recomputed_steps(plan.steps, plan.snapshots) : 0;
  return plan;
}

ModelGradient differentiate_run(const Model& model, const StepSequence& steps, Observer& observer, const MemoryPlan& plan,
                                SnapshotPool& pool, RunCost& cost, const std::function<bool()>& stop) {
  const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model);
  ModelGradient gradient = Reversal(*solver, steps, observer, plan.snapshots, pool, stop).run(cost);
  cost.measured_peak_bytes = peak_memory_bytes();
  return gradient;
}

}  // namespace jaxmpm
