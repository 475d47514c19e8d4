#include "core/background.hpp"

#include <system_error>
#include <utility>

#include "core/runtime.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {

void Background::start(std::function<void()> job) {
  wait();
  if (!own_thread_) return job();
  job_ = std::move(job);
  try {
    running_ = std::async(std::launch::async, [this] { run(); });
  } catch (const std::system_error&) {  // the system gives no more threads
    std::exchange(job_, {})();
  }
}

void Background::run() {
  leave_place();
  const Timed timed(cost_.wall);
  job_();
  cost_.processor = thread_seconds();
}

void Background::wait() {
  if (!running_.valid()) return;
  double waited = 0;
  {
    const Timed timed(waited);
    running_.wait();
  }
  job_ = {};
  const Cost cost = std::exchange(cost_, {});
  if (waited < cost.wall) seconds_beside_ += cost.processor * (1 - waited / cost.wall);
  running_.get();
}

}  // namespace jaxmpm
