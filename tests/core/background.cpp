// Jobs beside the main thread.
#include "core/background.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace jaxmpm;

TEST_CASE("jobs run one after another, beside their caller or in its thread") {
  const bool own_thread = GENERATE(false, true);
  std::vector<int> done;
  std::thread::id where;
  Background background(own_thread);
  for (int k = 0; k < 5; ++k)
    background.start([&done, &where, k] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      done.push_back(k), where = std::this_thread::get_id();
    });
  background.wait();
  CHECK(done == std::vector<int>{0, 1, 2, 3, 4});
  CHECK((where != std::this_thread::get_id()) == own_thread);
  CHECK(background.seconds_beside() >= 0);
  CHECK(background.seconds_beside() < 0.01);  // they sleep
}

TEST_CASE("what a job throws comes once, and before the next job starts") {
  Background background(true);
  bool started = false;
  background.start([] { throw std::runtime_error("the disk is full"); });
  CHECK_THROWS_WITH(background.start([&] { started = true; }), "the disk is full");
  background.wait();
  CHECK_FALSE(started);
  CHECK_THROWS_AS(Background(false).start([] { throw std::logic_error("at once"); }), std::logic_error);
}

TEST_CASE("a job ends before the object that runs it") {
  std::atomic<bool> done{false};
  {
    Background background(true);
    background.start([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      done = true;
    });
  }
  CHECK(done);
}
