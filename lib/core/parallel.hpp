#pragma once
// Labelled parallel loops: the only home of Kokkos policies.
#include <Kokkos_Core.hpp>
#include <cstddef>
#include <string>

namespace jaxmpm {

using Host = Kokkos::DefaultHostExecutionSpace;

/// Runs f(i) for i = 0 … n−1 on the host's threads; iterations differ in cost, so they are handed out as threads become free.
template <class F>
void parallel_for_host(const std::string& label, std::size_t n, const F& f) {
  if (n == 0) return;
  if (n == 1 || Host().concurrency() == 1) {
    for (std::size_t i = 0; i < n; ++i) f(i);
    return;
  }
  using Policy = Kokkos::RangePolicy<Host, Kokkos::Schedule<Kokkos::Dynamic>, Kokkos::IndexType<std::size_t>>;
  Policy policy(0, n);
  policy.set_chunk_size(n >= 1024 ? 4 : 1);
  Kokkos::parallel_for(label, policy, f);
}

/// The same with equal shares for each thread, for loops over particles.
template <class F>
void parallel_for_host_static(const std::string& label, std::size_t n, const F& f) {
  if (n == 0) return;
  using Policy = Kokkos::RangePolicy<Host, Kokkos::Schedule<Kokkos::Static>, Kokkos::IndexType<std::size_t>>;
  Kokkos::parallel_for(label, Policy(0, n), f);
}

}  // namespace jaxmpm
