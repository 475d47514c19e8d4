// The run loop against a solver with known answers.
#include "solvers/simulation.hpp"

#include <catch2/catch.hpp>

#include "ballistic.hpp"

using namespace jaxmpm;
using testing::Ballistic;

namespace {

struct Log : Recorder {
  std::vector<Moment> frames, readings, checkpoints;
  SavedState state;
  void frame(const Moment& now) override { frames.push_back(now); }
  void gauges(const Moment& now) override { readings.push_back(now); }
  void checkpoint(const Moment& now, SavedState saved, double) override {
    checkpoints.push_back(now);
    state = std::move(saved);
  }
  void wait() override {}
  double seconds_beside() const override { return 0; }
  void progress(const Moment&, double) override {}
};

RunSettings settings(double frames, double gauges) {
  RunSettings s;
  s.frame_interval = frames;
  s.gauge_interval = gauges;
  return s;
}

bool same_state(const Solver& a, const Solver& b) {
  const auto left = a.save(), right = b.save();
  for (std::size_t k = 0; k < left.size(); ++k)
    if (left[k].bytes != right[k].bytes) return false;
  return true;
}

}  // namespace

TEST_CASE("a run records step 0, its schedule and the end") {
  const Model model = testing::ballistic_model();
  Ballistic solver(model);
  Log log;
  const RunOutcome outcome = Simulation({1.0, 0.1, 0.4}, settings(0.4, 0.2), solver, log).run();
  CHECK(outcome.finished);
  CHECK(outcome.steps == 10);
  REQUIRE(log.frames.size() == 4);  // 0, 0.4, 0.8 and the end
  CHECK(log.frames[1].step == 4);
  CHECK(log.frames[3].step == 10);
  CHECK(log.readings.size() == 6);
  CHECK(log.checkpoints.back().step == 9);
}

TEST_CASE("the checkpoint of a finished run lies before its last step") {
  const Model model = testing::ballistic_model();
  Ballistic solver(model);
  Log log;
  const RunOutcome outcome = Simulation({0.5, std::nullopt, 0.4}, settings(0.2, 0.1), solver, log).run();
  CHECK(outcome.at.time == 0.5);
  CHECK(log.checkpoints.back().step == outcome.at.step - 1);

  SECTION("so that a later end continues as if the earlier had never been") {
    Ballistic longer(model), resumed(model);
    Log of_longer, of_resumed;
    Simulation({1.0, std::nullopt, 0.4}, settings(0.2, 0.1), longer, of_longer).run();
    resumed.restore(*log.state);
    Simulation({1.0, std::nullopt, 0.4}, settings(0.2, 0.1), resumed, of_resumed).run({log.checkpoints.back(), true, 0});
    CHECK(same_state(longer, resumed));
    CHECK(of_resumed.frames.size() == 3);  // 0.6, 0.8, 1.0; the others came before
    CHECK(of_resumed.frames.back().time == of_longer.frames.back().time);
    CHECK(of_resumed.frames[0].step == of_longer.frames[3].step);
  }
}

TEST_CASE("stop at any step and resume: the same steps, states and outputs", "[resume]") {
  const Model model = testing::ballistic_model();
  Ballistic whole(model);
  Log of_whole;
  const deck::Time time{0.3, std::nullopt, 0.4};
  Simulation(time, settings(0.05, 0.02), whole, of_whole).run();
  for (const int stop_after : {0, 1, 7, 20}) {
    Ballistic first(model), second(model);
    Log before, after;
    RunSettings stopped = settings(0.05, 0.02);
    stopped.stop_requested = [&] { return first.steps >= stop_after; };
    const RunOutcome outcome = Simulation(time, stopped, first, before).run();
    REQUIRE_FALSE(outcome.finished);
    REQUIRE(before.checkpoints.size() == 1);
    second.restore(*before.state);
    CHECK(Simulation(time, settings(0.05, 0.02), second, after).run({before.checkpoints[0], true, 0}).finished);
    CHECK(same_state(whole, second));
    CHECK(before.frames.size() + after.frames.size() == of_whole.frames.size());
    CHECK(before.readings.size() + after.readings.size() == of_whole.readings.size());
    CHECK(first.steps + second.steps == whole.steps);
  }
}

TEST_CASE("neither output nor checkpoints change the steps") {
  const Model model = testing::ballistic_model();
  Ballistic much(model), little(model);
  Log a, b;
  RunSettings often = settings(0.001, 0.0003);
  often.checkpoint_seconds = 1e-9;
  Simulation({0.2, std::nullopt, 0.4}, often, much, a).run();
  Simulation({0.2, std::nullopt, 0.4}, settings(1, 1), little, b).run();
  CHECK(a.checkpoints.size() > 10);
  CHECK(same_state(much, little));
  CHECK(much.steps == little.steps);
}

TEST_CASE("wall time stops a run with a checkpoint") {
  const Model model = testing::ballistic_model();
  Ballistic solver(model);
  Log log;
  RunSettings s = settings(1, 1);
  s.walltime_seconds = 1e-9;
  CHECK_FALSE(Simulation({1, 0.1, 0.4}, s, solver, log).run().finished);
  CHECK(log.checkpoints.size() == 1);
}

TEST_CASE("a step that fails leaves the state before it") {
  const Model model = testing::ballistic_model();
  Ballistic solver(model), good(model);
  solver.fails_at = 0.55;
  Log log;
  Simulation simulation({1.0, 0.1, 0.4}, settings(0.4, 0.4), solver, log);
  try {
    simulation.run();
    FAIL("did not throw");
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    CHECK(text.find("particle 0 is lost") != std::string::npos);
    CHECK(text.find("step 6") != std::string::npos);
    CHECK(text.find("last good state (step 5") != std::string::npos);
  }
  for (int n = 0; n < 5; ++n) good.step(0.1);
  CHECK(log.checkpoints.back().step == 5);
  CHECK(log.frames.back().step == 5);
  CHECK(same_state(solver, good));
}
