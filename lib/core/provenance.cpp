#include "core/provenance.hpp"

#include <unistd.h>

#include <Kokkos_Core.hpp>
#include <fstream>
#include <string>

#include "jaxmpm_git_commit.hpp"  // written at build time, see cmake/provenance.cmake

namespace jaxmpm {
namespace {

constexpr int widest_vector_bits() {
#if defined(__AVX512F__)
  return 512;
#elif defined(__AVX__)
  return 256;
#else
  return 128;
#endif
}

std::string kokkos_version() {
  return std::to_string(KOKKOS_VERSION / 10000) + '.' + std::to_string(KOKKOS_VERSION / 100 % 100) + '.' +
         std::to_string(KOKKOS_VERSION % 100);
}

std::string kokkos_backends() {
  std::string names;
  const auto add = [&](const char* name) { names += (names.empty() ? "" : ", ") + std::string(name); };
#if defined(KOKKOS_ENABLE_CUDA)
  add("Cuda");
#endif
#if defined(KOKKOS_ENABLE_OPENMP)
  add("OpenMP");
#endif
#if defined(KOKKOS_ENABLE_THREADS)
  add("Threads");
#endif
#if defined(KOKKOS_ENABLE_SERIAL)
  add("Serial");
#endif
  return names;
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace

const Provenance& provenance() {
  static const Provenance facts{JAXMPM_VERSION,   JAXMPM_GIT_COMMIT, compiler(),          JAXMPM_BUILD_TYPE,
                                kokkos_version(), kokkos_backends(), widest_vector_bits()};
  return facts;
}

std::size_t resident_bytes() {
  std::size_t program = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> program >> resident;
  return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

// getrusage() will not do: a program that another one started inherits that one's peak through fork and exec.
std::size_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  std::size_t kibibytes = 0;
  for (std::string word; status >> word;)
    if (word == "VmHWM:") status >> kibibytes;
  return kibibytes * 1024;
}

}  // namespace jaxmpm
