#pragma once
// Particles to grid on a device (Eqs 10–12, B.1, B.2): a team a tile, its arena in shared memory, one particle a thread.
#include "kernels/device/stencil.hpp"

namespace jaxmpm {

/// What a particle gives to its nodes: `mass` and `momentum` go with w, columns k of `affine` and `impulse` with the factor of axis k (d; g
/// or d for the impulse of the internal force, by the gradient's form).
template <class Sch>
struct ParticleGift {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  T mass, momentum[Dim];  // m, m v
  T affine[Dim][Dim];     // [axis][component] m C Δx
  T impulse[Dim][Dim];    // [axis][component] −Δt V σ / Δx, mls: D⁻¹ Δx instead of 1/Δx

  template <class Law>
  JAXMPM_INLINE ParticleGift(const ParticleFields<T, Dim>& f, std::size_t p, const Law& law, const StepConstants<T>& step) {
    constexpr int history = Law::template history_size<Dim>();
    T h[history > 0 ? history : 1];
    for (int k = 0; k < history; ++k) h[k] = f.history(k, p);
    const T e = f.compression(p);
    mass = f.mass(p);
    const Symmetric<T, Dim> sigma = law.template stress<T, Dim>(e, h);
    const T per_cell = Sch::mls ? T(1 / Bspline<Sch::S>::second_moment) / step.cell_size : T(1) / step.cell_size;
    const T volume = mass * (-step.dt * per_cell / law.density) / (T(1) + e);  // −Δt V / Δx
    const T scale = mass * step.cell_size;
    for (int c = 0; c < Dim; ++c) {
      momentum[c] = mass * f.velocity(c, p);
      for (int k = 0; k < Dim; ++k) {
        impulse[k][c] = volume * sigma(c, k);
        affine[k][c] = T(0);
        if constexpr (Sch::affine) affine[k][c] = scale * f.affine(c * Dim + k, p);
      }
    }
  }
};

/// Adds a particle's gift to its team's arena.
template <class Sch>
JAXMPM_INLINE void scatter(const Stencil<Sch>& s, const ParticleGift<Sch>& q, typename Sch::T* arena) {
  using T = typename Sch::T;
  constexpr int Dim = Sch::Dim, last = Dim - 1;
  for (int r = 0; r < Stencil<Sch>::rows; ++r) {
    const auto row = s.row(r);
    T with_w[Dim], force_w[Dim];  // go with w along the row
    for (int c = 0; c < Dim; ++c) {
      with_w[c] = row.w * q.momentum[c], force_w[c] = T(0);
      for (int k = 0; k < last; ++k) {
        if constexpr (Sch::affine) with_w[c] += row.d[k] * q.affine[k][c];
        force_w[c] += (Sch::mls ? row.d[k] : row.g[k]) * q.impulse[k][c];
      }
    }
    for (int a = 0; a < Sch::S; ++a) {
      const T w = s.w[last][a], d = row.w * s.d[last][a], e = row.w * (Sch::mls ? s.d[last][a] : s.g[last][a]);
      T* node = arena + 4 * (s.base + row.node + a);
      Kokkos::atomic_add(node, w * row.w * q.mass);
      for (int c = 0; c < Dim; ++c) {
        T momentum = w * with_w[c];
        if constexpr (Sch::affine) momentum += d * q.affine[last][c];
        const T impulse = w * force_w[c] + e * q.impulse[last][c];
        if constexpr (Sch::flip) {
          Kokkos::atomic_add(node + 1 + c, momentum);
          Kokkos::atomic_add(node + Sch::arena_plane + 1 + c, impulse);
        } else {
          Kokkos::atomic_add(node + 1 + c, momentum + impulse);
        }
      }
    }
  }
}

template <class Sch, class Law, class Space>
struct ScatterTiles {
  using T = typename Sch::T;
  static constexpr std::size_t scratch = Sch::arena_size * sizeof(T) + 16;
  ParticleFields<T, Sch::Dim> particles;
  TileTable<T, Sch::Dim> table;
  Law law;
  StepConstants<T> step;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const Tile tile = table.tiles[team.league_rank()];
    const Index<Sch::Dim> origin = table.origin(tile);
    T* arena = team_memory<T>(team, Sch::arena_size);
    team_for(team, Sch::arena_size, [&](int i) { arena[i] = T(0); });
    team.team_barrier();
    const int count = int(tile.end - tile.begin), threads = team.team_size();
    for (int first = 0; first < count; first += threads) {
      const int i = spread_particle(first, team.team_rank(), threads);
      if (i >= count) continue;
      const std::size_t p = tile.begin + std::size_t(i);
      scatter<Sch>(Stencil<Sch>(particles, p, origin), ParticleGift<Sch>(particles, p, law, step), arena);
    }
    team.team_barrier();
    T* out = table.arenas + std::size_t(team.league_rank()) * Sch::arena_size;
    team_for(team, Sch::arena_size, [&](int i) { out[i] = arena[i]; });
  }
};

}  // namespace jaxmpm
