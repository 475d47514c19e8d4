#pragma once
// Labelled parallel loops on any execution space. Those of the host are in parallel_host.hpp; Kokkos policies live here and there alone.
#include <Kokkos_Core.hpp>
#include <cstddef>
#include <string>
#include <type_traits>

#include "core/macros.hpp"

namespace jaxmpm {

using Host = Kokkos::DefaultHostExecutionSpace;

/// Whether an execution space works in the host's memory.
template <class Space>
inline constexpr bool on_host = std::is_same_v<typename Space::memory_space, Kokkos::HostSpace>;

/// Memory of the host that an execution space reaches.
#if defined(KOKKOS_ENABLE_CUDA)
template <class Space>
using PinnedSpace = std::conditional_t<on_host<Space>, Kokkos::HostSpace, Kokkos::CudaHostPinnedSpace>;
#else
template <class Space>
using PinnedSpace = Kokkos::HostSpace;
#endif

/// Runs f(i) for i = 0 … n−1 on any execution space, in its queue.
template <class Space, class F>
void parallel_for_on(const std::string& label, const Space& space, std::size_t n, const F& f) {
  if (n > 0) Kokkos::parallel_for(label, Kokkos::RangePolicy<Space, Kokkos::IndexType<std::size_t>>(space, 0, n), f);
}

/// Scan over i = 0 … n−1: f(i, sum, final) adds its share to `sum`, which holds the shares of all i before; acts where `final`. Returns the
/// total, so it waits.
template <class Space, class F>
typename F::value_type parallel_scan_on(const std::string& label, const Space& space, std::size_t n, const F& f) {
  typename F::value_type total = 0;
  if (n > 0) Kokkos::parallel_scan(label, Kokkos::RangePolicy<Space, Kokkos::IndexType<std::size_t>>(space, 0, n), f, total);
  return total;
}

template <class Space>
using Team = typename Kokkos::TeamPolicy<Space>::member_type;

/// Runs f(team) for teams of `threads` threads (of one on the host) that share `scratch` bytes; teams are numbered by league_rank(). A
/// processor of the device shall have room for `resident` teams: the compiler keeps to so many registers (0: as it likes).
template <int threads, int resident, class Space, class F>
void parallel_for_teams(const std::string& label, const Space& space, std::size_t teams, std::size_t scratch, const F& f) {
  if (teams == 0) return;
  Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<unsigned(threads), unsigned(resident)>> policy(space, int(teams),
                                                                                                on_host<Space> ? 1 : threads);
  Kokkos::parallel_for(label, policy.set_scratch_size(0, Kokkos::PerTeam(int(scratch))), f);
}

/// Shares i = 0 … n−1 among the threads of a team, neighbours to neighbours.
template <class Team, class F>
JAXMPM_INLINE void team_for(const Team& team, int n, const F& f) {
  for (int i = team.team_rank(); i < n; i += team.team_size()) f(i);
}

/// Part of the team's shared memory, which parallel_for_teams() was asked for; begins at a multiple of 16 bytes (ask for 16 more each
/// time).
template <class T, class Team>
JAXMPM_INLINE T* team_memory(const Team& team, int values) {
  return static_cast<T*>(team.team_scratch(0).get_shmem_aligned(values * int(sizeof(T)), 16));
}

/// Sum of the values of a team's threads; all of them have to call. The barrier keeps a reduction from overtaking the one before it, as
/// they use the same shared memory (Kokkos 3.4).
template <class Team>
JAXMPM_INLINE double team_sum(const Team& team, double value) {
  team.team_barrier();
  team.team_reduce(Kokkos::Sum<double>(value));
  return value;
}

/// Largest of the values of the threads that run in step, a warp of a device or one thread of the host; all of them have to call.
template <class T>
JAXMPM_INLINE T warp_max(T value) {
#if defined(__CUDA_ARCH__)
  for (int apart = 16; apart > 0; apart /= 2) {
    const T other = __shfl_xor_sync(0xffffffffu, value, apart);
    value = other > value ? other : value;
  }
#endif
  return value;
}
/// Whether a thread is the first of its warp.
template <class Team>
JAXMPM_INLINE bool leads_warp(const Team& team) {
  return team.team_rank() % 32 == 0;
}

}  // namespace jaxmpm
