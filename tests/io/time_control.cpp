// Which steps are taken and at which of them something is written.
#include "solvers/time_control.hpp"

#include <catch2/catch.hpp>

#include "core/error.hpp"

using namespace jaxmpm;

namespace {

/// Steps of a run with a constant stable step.
std::vector<Moment> steps_of(const deck::Time& time, double stable) {
  const TimeControl control(time);
  std::vector<Moment> all{{}};
  while (!control.done(all.back())) all.push_back(control.after_next(all.back(), stable));
  return all;
}

std::vector<std::uint64_t> outputs(const deck::Time& time, double stable, double interval) {
  const OutputSchedule schedule("frames", interval, TimeControl(time));
  std::vector<std::uint64_t> taken;
  for (const Moment& now : steps_of(time, stable))
    if (schedule.due(now)) taken.push_back(now.step);
  return taken;
}

using Steps = std::vector<std::uint64_t>;

}  // namespace

TEST_CASE("a fixed step ends at k dt exactly and at the nearest whole number of steps") {
  const auto steps = steps_of({0.3, 0.1, 0.4}, 0);
  REQUIRE(steps.size() == 4);
  CHECK(steps[3].time == 3 * 0.1);
  CHECK(TimeControl({0.3, 0.1, 0.4}).notices().empty());
  const TimeControl moved({0.34, 0.1, 0.4});
  CHECK(moved.end() == 3 * 0.1);
  REQUIRE(moved.notices().size() == 1);
  CHECK(moved.notices()[0].find("/time/end") != std::string::npos);
  CHECK(steps_of({0.04, 0.1, 0.4}, 0).size() == 2);  // never less than one step
}

TEST_CASE("an automatic step is the stable one, and only the last is shortened") {
  const auto steps = steps_of({1.0, std::nullopt, 0.4}, 0.3);
  REQUIRE(steps.size() == 5);
  CHECK(steps[3].dt == 0.3);
  CHECK(steps[4].time == 1.0);
  CHECK(steps[4].dt == Approx(0.1));
  CHECK(steps[4].before == steps[3].time);
}

TEST_CASE("no sliver of a step is left for the end") {
  const auto steps = steps_of({1.0, std::nullopt, 0.4}, 0.1);  // ten times 0.1 is 0.9999999999999999
  REQUIRE(steps.size() == 11);
  CHECK(steps.back().time == 1.0);
}

TEST_CASE("a step that stands still is an error, not an endless run") {
  const TimeControl control({1.0, std::nullopt, 0.4});
  CHECK_THROWS_AS(control.after_next({}, 0.0), NumericsError);
  CHECK_THROWS_AS(control.after_next({}, std::nan("")), NumericsError);
  CHECK_THROWS_AS(control.after_next({7, 0.5, 0.1, 0.4}, 1e-20), NumericsError);
}

TEST_CASE("output comes at the first automatic step at or after its time") {
  CHECK(outputs({1.0, std::nullopt, 0.4}, 0.3, 0.5) == Steps{0, 2, 4});            // 0.6, 1.0
  CHECK(outputs({1.0, std::nullopt, 0.4}, 0.1, 0.2) == Steps{0, 2, 4, 6, 8, 10});  // met within rounding
  CHECK(outputs({1.0, std::nullopt, 0.4}, 0.3, 0.01) == Steps{0, 1, 2, 3, 4});     // many times in one step: once
  CHECK(outputs({1.0, std::nullopt, 0.4}, 0.3, 5) == Steps{0});
}

TEST_CASE("with a fixed step output comes at the nearest step") {
  CHECK(outputs({1.0, 0.1, 0.4}, 0, 0.2) == Steps{0, 2, 4, 6, 8, 10});
  CHECK(outputs({1.0, 0.1, 0.4}, 0, 0.24) == Steps{0, 2, 5, 7, 10});  // 0.24, 0.48, 0.72, 0.96
  CHECK(outputs({0.4, 0.1, 0.4}, 0, 0.03) == Steps{0, 1, 2, 3, 4});
  const TimeControl control({1.0, 0.1, 0.4});
  CHECK(OutputSchedule("frames", 0.2, control).notices().empty());
  CHECK(OutputSchedule("frames", 0.24, control).notices().size() == 1);
}

TEST_CASE("a hundred thousand fixed steps keep their output on the step") {
  const deck::Time time{1.0, 1e-5, 0.4};
  const OutputSchedule schedule("frames", 1e-3, TimeControl(time));
  std::uint64_t count = 0;
  Moment now;
  const TimeControl control(time);
  for (; !control.done(now); now = control.after_next(now, 0)) {
    CHECK(schedule.due(now) == (now.step % 100 == 0));
    count += schedule.due(now);
  }
  CHECK(count == 1000);
}
