#include "inverse/differentiated_run.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/stopwatch.hpp"
#include "inverse/checkpoint_schedule.hpp"
#include "solvers/reversible.hpp"
#include "spdlog/fmt/fmt.h"

namespace jaxmpm {
namespace {

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

/// Blocks of the grid that kept states have room for: where sums do not fit, states are whole or steps scatter again, so a few more than in
/// the recorded run.
std::size_t expected_blocks(const StepSequence& steps) { return steps.most_blocks + steps.most_blocks / 8; }

/// Thrown where more states are whole than were planned.
struct TooManyWhole {};

/// The reverse run: a stack of kept states, the newest below the step that is reversed next.
class Reversal {
 public:
  Reversal(ReversibleSolver& solver, const StepSequence& steps, Observer& observer, const MemoryPlan& plan, SnapshotStack& stack,
           const std::function<bool()>& stop)
      : solver_(solver),
        steps_(steps),
        observer_(observer),
        stop_(stop),
        walk_(solver.forward(), steps, observer, stop),
        snapshots_(plan.snapshots),
        lean_(plan.lean > 0),
        whole_left_(plan.snapshots - plan.lean),
        numbers_(stack) {
    solver.expect_blocks(expected_blocks(steps));
    numbers_.prepare(solver.kept_bytes(), {plan.snapshots - plan.on_disk, plan.on_disk, plan.lean, solver.lean_bytes()});
    keep(0);
  }

  ModelGradient run(RunCost& cost) {
    const Stopwatch watch;
    if (steps_.dt.empty()) start_reverse(0);
    for (std::size_t end = steps_.dt.size(); end > 0;) {
      ask(stop_);
      const std::size_t start = kept_.back().state;
      if (end - start > 1) {
        go_to(start);
        const std::size_t next = start + steps_to_next_snapshot(end - start, snapshots_ - kept_.size());
        walk_.advance(start, next);
        if (next == start + 1) keep_sums();
        keep(next);
        continue;
      }
      if (end == steps_.dt.size()) {
        go_to(start), walk_.advance(start, end);
        keep_sums();
        cost.forward_seconds = watch.seconds();
        start_reverse(end);
      }
      reverse_step(start);
      end = start;
    }
    solver_.end_reverse();
    cost.reverse_seconds = watch.seconds() - cost.forward_seconds;
    cost.particles_at_kinks = solver_.at_kinks();
    return solver_.gradient();
  }

 private:
  struct Snapshot {
    std::size_t state;
    std::unique_ptr<KeptState> rest;
  };
  static constexpr std::size_t lost = ~std::size_t(0);

  void keep(std::size_t state) {
    const bool lean = lean_ && solver_.may_be_lean();
    if (!lean && lean_ && whole_left_-- == 0) throw TooManyWhole{};
    kept_.push_back({state, solver_.keep(numbers_.push(lean), lean)});
    present_ = state;
  }
  void keep_sums() { solver_.keep_sums(*kept_.back().rest, numbers_.change_top()); }
  void forget() {
    numbers_.pop();
    kept_.pop_back();
  }
  void go_back() { solver_.go_back(*kept_.back().rest, numbers_.top()); }
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
    solver_.step_adjoint(steps_.dt[start], *kept_.back().rest, numbers_.top());
    // The solver still reads what is forgotten now, which is whole until something else comes to lie there.
    if (start == 0 || looked_at(start) || numbers_.fetches_next()) go_back();
    add_looks(start);
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
  bool lean_;
  std::size_t whole_left_;
  std::vector<Snapshot> kept_;
  SnapshotStack& numbers_;  // of kept_
};

/// How many snapshots are kept where.
struct Split {
  std::size_t in_memory, on_disk;
  std::size_t all() const { return in_memory + on_disk; }
};

/// As many snapshots as there is room for, `wanted` at most, and no more of them on disk than that takes. What states share stays in
/// memory; for those on disk that may take half of the room, so that the newest snapshots, which come and go, need not go through the disk.
Split split_snapshots(const ReversibleSolver& solver, std::size_t wanted, const Room& room) {
  const std::size_t numbers = solver.kept_bytes(), shared = solver.shared_bytes();
  const auto beside = [&](std::size_t on_disk) {
    const std::size_t taken = on_disk * shared;
    return room.memory > taken ? (room.memory - taken) / (numbers + shared) : 0;
  };
  Split split{beside(0), 0};
  const auto allowed = [&](std::size_t on_disk) {
    return on_disk * numbers <= room.disk && 2 * on_disk * shared <= room.memory && beside(on_disk) > 0;
  };
  while (split.all() < wanted && allowed(split.on_disk + 1)) split.in_memory = beside(++split.on_disk);
  split.in_memory = std::min(split.in_memory, wanted - split.on_disk);
  return split;
}

/// How many of all states of a run can be lean: the first one is not, nor those before and after a sort. They are counted as of the recorded
/// run with a good margin, since the unknowns of an inversion change how often particles are sorted.
std::size_t lean_states(const ReversibleSolver& solver, const StepSequence& steps) {
  const std::size_t whole = 8 + 3 * std::size_t(steps.sorts);
  return solver.lean_bytes() < solver.kept_bytes() && steps.dt.size() > whole ? steps.dt.size() - whole : 0;
}

/// The adjoint of one step, after which a stepper has all its memory.
void try_adjoint(ReversibleSolver& solver, Backend backend, double dt) {
  SnapshotPool pool(make_state_memory(backend));
  pool.prepare(solver.kept_bytes(), 1, 1);
  std::byte* numbers = pool.take();
  const std::unique_ptr<KeptState> kept = solver.keep(numbers, false);
  solver.start_reverse();
  solver.step_adjoint(dt, *kept, numbers);
  solver.end_reverse();
}

/// The next moment of a run that also meets the observer's times.
Moment next_moment(const TimeControl& control, const Moment& now, double stable, double look) {
  const Moment free = control.after_next(now, stable);
  constexpr double sliver = 1e-9;  // of a step: no rest that small is left over
  if (!control.is_automatic() || free.time + sliver * free.dt < look) return free;
  return {now.step + 1, look, look - now.time, now.time};
}

}  // namespace

StepSequence record_run(const Model& model, Backend backend, Observer& observer, const std::function<bool()>& stop) {
  const std::unique_ptr<ReversibleSolver> reversible = make_reversible_solver(model, backend);
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
    steps.most_blocks = std::max(steps.most_blocks, solver.active_blocks());
  }
  steps.sorts = solver.sorts();
  if (!steps.dt.empty()) steps.note = moving_note(model, solver, now.time);
  return steps;
}

void replay_run(const Model& model, Backend backend, const StepSequence& steps, Observer& observer, const std::function<bool()>& stop) {
  const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model, backend);
  Walk(solver->forward(), steps, observer, stop).advance(0, steps.dt.size());
}

MemoryPlan plan_gradient(const Model& model, const StepSequence& steps, const Room& room, const SnapshotStack& stack) {
  const StateMemory& memory = stack.memory();
  const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model, memory.backend());
  solver->expect_blocks(expected_blocks(steps));
  if (!steps.dt.empty()) try_adjoint(*solver, memory.backend(), steps.dt[0]);
  MemoryPlan plan;
  plan.steps = steps.dt.size();
  plan.snapshot_bytes = solver->kept_bytes() + solver->shared_bytes();
  // Besides snapshots: the program as it stands, with this stepper in it and less the stack's memory, blocks that the material has yet to
  // reach, and what the observer sees and the gradient: less than four states, as measured.
  const std::size_t used = memory.used(), now = solver->forward().active_blocks();
  const std::size_t to_come = (std::max(steps.most_blocks, now) - now) * solver->block_bytes();
  constexpr std::size_t varying = 1 << 20;  // what is resident is not quite the same in the next run
  const std::size_t fixed = used - std::min(stack.memory_bytes(), used) + to_come + 4 * plan.snapshot_bytes + varying;
  constexpr std::size_t least = 2;
  const std::size_t wanted = std::max<std::size_t>(plan.steps, 1);
  const std::size_t left = room.memory - std::min(fixed, room.memory), lean = lean_states(*solver, steps);
  const std::size_t all = lean * solver->lean_bytes() + (plan.steps - lean) * plan.snapshot_bytes;
  const Split split = split_snapshots(*solver, wanted, {left, room.disk});
  if (lean > 0 && all <= left) {
    plan.lean = lean, plan.snapshots = plan.steps;
    plan.whole_snapshots = split.all(), plan.whole_on_disk = split.on_disk;
    plan.snapshot_bytes = all / plan.steps, plan.peak_bytes = fixed + all;
    return plan;
  }
  constexpr double mib = 1 << 20;
  if (split.all() < least && plan.steps > 1)
    throw Error(ExitCode::deck,
                fmt::format("/inverse/memory: {:.1f} MiB are too few: a reverse run of this scene takes {:.1f} MiB and at least "
                            "{} snapshots of {:.2f} MiB; give it {:.0f} MiB or more",
                            double(room.memory) / mib, double(fixed) / mib, least, double(plan.snapshot_bytes) / mib,
                            std::ceil(double(fixed + least * plan.snapshot_bytes + varying) / mib)));
  plan.snapshots = std::max<std::size_t>(split.all(), 1), plan.on_disk = split.on_disk;
  plan.disk_bytes = plan.on_disk * solver->kept_bytes();
  plan.peak_bytes = fixed + plan.snapshots * plan.snapshot_bytes - plan.disk_bytes;
  plan.recomputed_steps = plan.steps > 1 ? recomputed_steps(plan.steps, plan.snapshots) : 0;
  return plan;
}

ModelGradient differentiate_run(const Model& model, const StepSequence& steps, Observer& observer, const MemoryPlan& plan,
                                SnapshotStack& stack, RunCost& cost, const std::function<bool()>& stop) {
  const auto run = [&](const MemoryPlan& as_planned) {
    const std::unique_ptr<ReversibleSolver> solver = make_reversible_solver(model, stack.memory().backend());
    return Reversal(*solver, steps, observer, as_planned, stack, stop).run(cost);
  };
  ModelGradient gradient;
  try {
    gradient = run(plan);
  } catch (const TooManyWhole&) {
    MemoryPlan whole = plan;
    whole.lean = 0, whole.snapshots = plan.whole_snapshots, whole.on_disk = plan.whole_on_disk;
    gradient = run(whole);
  }
  cost.measured_peak_bytes = stack.memory().most_used();
  cost.written_bytes = stack.file().written_bytes(), cost.read_bytes = stack.file().read_bytes();
  return gradient;
}

}  // namespace jaxmpm
