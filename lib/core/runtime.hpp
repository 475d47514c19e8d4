#pragma once
// Kokkos for as long as an object of this class lives; the one place that knows how its versions are started.
#include <optional>

namespace jaxmpm {

class Runtime {
 public:
  /// Starts Kokkos with a number of host threads (all that the system offers when empty). Throws Error (exit 2) when the build asks for a
  /// device and none is found.
  explicit Runtime(std::optional<int> threads);
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;
};

/// Host threads in use.
int thread_count();

/// Lets the calling thread run on all processors that the process may use, where OpenMP has bound the thread that started it to one.
void leave_place();

/// Processor time of all threads so far, s. Unlike time by the clock it leaves out what other programs had of the processors.
double processor_seconds();
/// That of the calling thread.
double thread_seconds();

}  // namespace jaxmpm
