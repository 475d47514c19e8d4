#pragma once
// Work beside the main thread's.
#include <functional>
#include <future>

namespace jaxmpm {

/// Does one job at a time on a thread of its own, which may run on any of the process's processors even where OpenMP binds its threads to
/// one each; or at once in the caller's, where that is what is asked for.
class Background {
 public:
  explicit Background(bool own_thread) : own_thread_(own_thread) {}
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// Waits for the job before, and starts one. Throws what the job before threw, and then starts nothing.
  void start(std::function<void()> job);
  /// Waits for the last job. Throws what it threw, once.
  void wait();
  /// Processor time of the jobs so far, without what they took while they were waited for, s.
  double seconds_beside() const { return seconds_beside_; }

 private:
  void run();

  struct Cost {
    double wall = 0, processor = 0;  // s
  };

  bool own_thread_;
  double seconds_beside_ = 0;
  Cost cost_;                  // of the last job
  std::function<void()> job_;  // that runs
  std::future<void> running_;  // waits when it goes, so that what a job refers to has to outlive this object
};

}  // namespace jaxmpm
