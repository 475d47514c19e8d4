// Catch2's main with Kokkos around it.
#define CATCH_CONFIG_RUNNER
#include <cstdlib>

#include <Kokkos_Core.hpp>
#include <catch2/catch.hpp>

int main(int argc, char** argv) {
  // Without it Kokkos warns on standard output, where ctest takes the lines for names of tests.
  ::setenv("OMP_PROC_BIND", "false", 0);
  const Kokkos::ScopeGuard kokkos(argc, argv);
  return Catch::Session().run(argc, argv);
}
