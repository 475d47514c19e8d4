#pragma once
// Which particles stand in which cell now, as linked lists in a team's memory: their storage order is that of the last sort.
#include <cstdint>

#include "core/parallel.hpp"

namespace jaxmpm {

/// Lists of up to `capacity` particles, numbered from 0, by the node (of `nodes`) that is their base.
template <int nodes, int capacity>
struct CellLists {
  static constexpr int none = -1;
  static_assert(nodes < 65536 && capacity < 32768);
  int count;                      // of occupied
  int head[nodes];                // a particle of the node, or none
  std::uint16_t occupied[nodes];  // the nodes with particles, in any order
  std::int16_t next[capacity];    // the particle behind, or none

  template <class Team>
  JAXMPM_INLINE void clear(const Team& team) {
    team_for(team, nodes, [&](int node) { head[node] = none; });
    if (team.team_rank() == 0) count = 0;
  }
  JAXMPM_INLINE void add(int node, int particle) {
    const int behind = Kokkos::atomic_exchange(&head[node], particle);
    next[particle] = std::int16_t(behind);
    if (behind == none) occupied[Kokkos::atomic_fetch_add(&count, 1)] = std::uint16_t(node);
  }
};

}  // namespace jaxmpm
