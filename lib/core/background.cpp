#include "core/background.hpp"

#include "core/runtime.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {

void Background::start(std::function<void()> job) {
  wait();
  const auto timed_job = [this, job = std::move(job)] {
    const Timed timed(seconds_);
    job();
  };
  if (!own_thread_) return timed_job();
  running_ = std::async(std::launch::async, [timed_job] {
    leave_place();
    timed_job();
  });
}

void Background::wait() {
  if (running_.valid()) running_.get();
}

}  // namespace jaxmpm
