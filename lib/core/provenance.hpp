#pragma once
// Where the program comes from and what it was built with; goes into every result file and `jaxmpm info`.
#include <string>

namespace jaxmpm {

struct Provenance {
  std::string version;          ///< of the program
  std::string git_commit;       ///< full hash, with "+changes" when tracked files differed; "unknown" when built without git
  std::string compiler;         ///< name and version
  std::string build_type;       ///< CMake's, e.g. Release
  std::string kokkos_version;   ///< e.g. 3.4.1
  std::string kokkos_backends;  ///< execution spaces of this build, separated by ", "
  int vector_bits = 0;          ///< widest vector registers that the compiler was allowed to use
};

const Provenance& provenance();

/// Largest memory that this process has had resident so far, bytes.
std::size_t peak_memory_bytes();
/// Memory that the process occupies now.
std::size_t resident_bytes();

}  // namespace jaxmpm
