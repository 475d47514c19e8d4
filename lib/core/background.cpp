#include "core/background.hpp"

#include <system_error>
#include <utility>

#include "core/runtime.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {

void Background::start(const std::function<void()>& job) {
  wait();
  if (!own_thread_) return job();
  const auto timed_job = [this, job] {
    leave_place();
    const Timed timed(cost_.wall);
    job();
    cost_.processor = thread_seconds();
  };
  try {
    running_ = std::async(std::launch::async, timed_job);
  } catch (const std::system_error&) {  // the system gives no more threads
    job();
  }
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
