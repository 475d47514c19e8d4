#include "core/runtime.hpp"

#include <omp.h>
#include <sched.h>

#include <Kokkos_Core.hpp>
#include <ctime>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace jaxmpm {

Runtime::Runtime(std::optional<int> threads) {
  try {
#if KOKKOS_VERSION >= 30700
    Kokkos::InitializationSettings settings;
    if (threads) settings.set_num_threads(*threads);
    settings.set_disable_warnings(true);
#else
    Kokkos::InitArguments settings;
    if (threads) settings.num_threads = *threads;
    settings.disable_warnings = true;
#endif
    Kokkos::initialize(settings);
  } catch (const std::exception& error) {
    throw Error(ExitCode::deck, std::string("the parallel runtime (Kokkos) did not start: ") + error.what() +
                                    "\nIf this build is for a GPU, run it on a machine that has one, or build for the CPU.");
  }
}

Runtime::~Runtime() { Kokkos::finalize(); }

int thread_count() { return Kokkos::DefaultHostExecutionSpace().concurrency(); }

void leave_place() {
#if defined(__linux__)
  cpu_set_t all;
  CPU_ZERO(&all);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> processors(std::size_t(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, processors.data());
    for (const int processor : processors) CPU_SET(processor, &all);
  }
  if (CPU_COUNT(&all) > 0) sched_setaffinity(0, sizeof(all), &all);  // without places threads are bound to nothing
#endif
}

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace jaxmpm
