#include "core/background.hpp"

#include <utility>

#include "core/runtime.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {

void Background::start(std::function<void()> job) {
  wait();
  if (!own_thread_) return job();
  running_ = std::async(std::launch::async, [this, job = std::move(job)] {
    leave_place();
    const Timed timed(cost_.wall);
    job();
    cost_.processor = thread_seconds();
  });
}

void Background::wait() {
  if (!running_.valid()) return;
  double waited = 0;
  {
    const Timed timed(waited);
    running_.wait();
  }
  const Cost cost = std::exchange(cost_, {});
  if (waited < cost.wall) seconds_beside_ += cost.processor * (1 - waited / cost.wall);
  running_.get();
}

}  // namespace jaxmpm
