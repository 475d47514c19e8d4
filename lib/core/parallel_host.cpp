#include "core/parallel_host.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "core/runtime.hpp"

namespace jaxmpm {
namespace {

/// Runs part p of a loop, `size` iterations each except for the last, for p = 0, 1, …
template <class Schedule>
void run_parts(const std::string& label, std::size_t n, std::size_t size, LoopPart part, const void* body) {
  if (n == 0) return;
  const std::size_t parts = pieces_of(n, size);
  if (parts == 1) return part(body, 0, n);
  using Policy = Kokkos::RangePolicy<Host, Schedule, Kokkos::IndexType<std::size_t>>;
  Policy policy(0, parts);
  policy.set_chunk_size(1);
  Kokkos::parallel_for(label, policy, [=](std::size_t p) { part(body, p * size, std::min(n, (p + 1) * size)); });
}

}  // namespace

void run_dynamic(const std::string& label, std::size_t n, LoopPart part, const void* body) {
  const std::size_t few = n >= 1024 ? 4 : 1;
  run_parts<Kokkos::Schedule<Kokkos::Dynamic>>(label, n, thread_count() == 1 ? n : few, part, body);
}

void run_static(const std::string& label, std::size_t n, LoopPart part, const void* body) {
  const auto threads = std::size_t(thread_count());
  run_parts<Kokkos::Schedule<Kokkos::Static>>(label, n, pieces_of(n, threads), part, body);
}

}  // namespace jaxmpm
