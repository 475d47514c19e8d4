#include "core/runtime.hpp"

#include <Kokkos_Core.hpp>
#include <ctime>
#include <string>

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

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace jaxmpm
