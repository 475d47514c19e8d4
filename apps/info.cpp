// jaxmpm info: what this program is and what it was built with.
#include <iostream>

#include "commands.hpp"
#include "core/provenance.hpp"

namespace jaxmpm {

int info() {
  const Provenance& p = provenance();
  std::cout << "jaxmpm " << p.version << "\ngit commit      " << p.git_commit << "\ncompiler        " << p.compiler << " (" << p.build_type
            << ")\nKokkos          " << p.kokkos_version << " with " << p.kokkos_backends << "\nbackends        cpu"
            << (has_backend(Backend::cuda) ? ", cuda" : "") << "\nvector width    " << p.vector_bits << " bits\nlanes           "
            << p.vector_bits / 32 << " (f32), " << p.vector_bits / 64 << " (f64)\n";
  return 0;
}

}  // namespace jaxmpm
