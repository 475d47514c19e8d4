#pragma once
// Grid to particles on a device (Eqs 15–18, B.1, B.2) and the stress that follows: a team a tile, its arena in shared memory, one particle
// a thread.
#include "kernels/device/stencil.hpp"

namespace jaxmpm {

/// What a step reports, gathered by all teams in device memory.
struct StepReport {
  static constexpr int fastest = 0, displacement = 1, plastic = 2, viscous = 3, unsound = 4,
                       size = 5;  // unsound: 1 where something went wrong
};

/// One thread's share of it.
struct ThreadReport {
  double fastest = 0, displacement = 0, lost = 0;
  double unsound = 0;
};

/// Σ over a particle's stencil of factor × node.
template <class Sch>
struct Gathered {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  T value[Dim], change[Dim];              // Σ w v, Σ w Δv
  T moments[Dim][Dim], slopes[Dim][Dim];  // [axis][component] Σ d v, Σ g v

  JAXMPM_INLINE Gathered(const Stencil<Sch>& s, const T* arena) {
    constexpr int last = Dim - 1;
    for (int c = 0; c < Dim; ++c) {
      value[c] = change[c] = T(0);
      for (int k = 0; k < Dim; ++k) moments[k][c] = slopes[k][c] = T(0);
    }
    for (int r = 0; r < Stencil<Sch>::rows; ++r) {
      const auto row = s.row(r);
      const T* node = arena + 4 * (s.base + row.node);
      for (int c = 0; c < Dim; ++c) {
        T w(0), d(0), g(0), dv(0);  // sums along the row
        for (int a = 0; a < Sch::S; ++a) {
          const T v = node[4 * a + 1 + c];
          w += s.w[last][a] * v;
          if constexpr (Sch::g2p_moments) d += s.d[last][a] * v;
          if constexpr (Sch::g2p_slopes) g += s.g[last][a] * v;
          if constexpr (Sch::flip) dv += s.w[last][a] * node[Sch::arena_plane + 4 * a + 1 + c];
        }
        value[c] += row.w * w;
        if constexpr (Sch::flip) change[c] += row.w * dv;
        for (int k = 0; k < last; ++k) {
          if constexpr (Sch::g2p_moments) moments[k][c] += row.d[k] * w;
          if constexpr (Sch::g2p_slopes) slopes[k][c] += row.g[k] * w;
        }
        if constexpr (Sch::g2p_moments) moments[last][c] += row.w * d;
        if constexpr (Sch::g2p_slopes) slopes[last][c] += row.w * g;
      }
    }
  }
};

template <class Sch, class Law, class Space>
struct GatherTiles {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  static constexpr std::size_t scratch = Sch::arena_size * sizeof(T) + 16;
  ParticleFields<T, Dim> particles;
  TileTable<T, Dim> table;
  Law law;
  StepConstants<T> step;
  const int* neighbour;  // Blocks::neighbour
  const T* grid;         // [block][own]
  Index<Dim> cells;      // of the domain
  bool account;
  double* report;  // StepReport

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const Tile tile = table.tiles[team.league_rank()];
    const Index<Dim> origin = table.origin(tile);
    T* arena = team_memory<T>(team, Sch::arena_size);
    load_arena(team, neighbour + std::size_t(tile.block) * Sch::Shape::neighbours, arena);
    team.team_barrier();
    ThreadReport mine;
    team_for(team, int(tile.end - tile.begin), [&](int i) {
      const std::size_t p = tile.begin + std::size_t(i);
      update(p, Gathered<Sch>(Stencil<Sch>(particles, p, origin), arena), mine);
    });
    give_report(team, mine);
  }

 private:
  /// Copies the grid around the tile's block into its arena, which begins one node below the block.
  JAXMPM_INLINE void load_arena(const Team<Space>& team, const int* around, T* arena) const {
    constexpr int A = Sch::Shape::A;
    team_for(team, Sch::Shape::arena_nodes, [&](int i) {
      Index<Dim> node{};
      for (int d = Dim - 1, rest = i; d >= 0; --d, rest /= A) node[std::size_t(d)] = rest % A - 1;
      const Place<Dim> at = locate<Dim>(around, Index<Dim>{}, node);
      for (int plane = 0; plane < Sch::planes; ++plane)
        for (int k = 0; k < 4; ++k)
          arena[plane * Sch::arena_plane + 4 * i + k] =
              grid[std::size_t(at.block) * Sch::own_size + std::size_t(plane * Sch::own_plane + 4 * at.own + k)];
    });
  }

  /// Moves a particle and advances its material.
  JAXMPM_INLINE void update(std::size_t p, const Gathered<Sch>& sum, ThreadReport& mine) const {
    T speed2 = T(0);
    for (int c = 0; c < Dim; ++c) {
      const T pic = sum.value[c];
      T v = pic;
      if constexpr (Sch::flip) v = step.flip_fraction * (particles.velocity(c, p) + sum.change[c]) + (T(1) - step.flip_fraction) * pic;
      particles.velocity(c, p) = v;
      speed2 += v * v;
      const T move = step.dt / step.cell_size * pic;
      mine.displacement = max(mine.displacement, double(abs(move)));
      double& X = particles.position(c, p);
      X += double(move);
      if (!(X >= 0.0 && X <= double(cells[std::size_t(c)]))) mine.unsound = 1;
    }
    const T per_slope = T(1) / step.cell_size;
    const T per_moment = Sch::S > 2 ? T(1 / Bspline<Sch::S>::second_moment) / step.cell_size : T(0);
    Matrix<T, Dim> H;
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        if constexpr (Sch::affine)
          particles.affine(c * Dim + k, p) = Sch::affine_by_moments ? per_moment * sum.moments[k][c] : per_slope * sum.slopes[k][c];
        const T gradient = Sch::mls ? per_moment * sum.moments[k][c] : per_slope * sum.slopes[k][c];
        H(c, k) = step.dt * gradient;
        if (particles.first_gradient >= 0) particles.gradient(c * Dim + k, p) = gradient;
      }
    advance(p, H, sqrt(speed2), mine);
  }

  JAXMPM_INLINE void advance(std::size_t p, const Matrix<T, Dim>& H, T speed, ThreadReport& mine) const {
    constexpr int history = Law::template history_size<Dim>();
    T h[history > 0 ? history : 1];
    for (int k = 0; k < history; ++k) h[k] = particles.history(k, p);
    T e = particles.compression(p);
    const T lost = law.template update<T, Dim>(H, step.dt, e, h);
    particles.compression(p) = e;
    for (int k = 0; k < history; ++k) particles.history(k, p) = h[k];
    const T fastest = law.template wave_speed<T, Dim>(e, h) + speed;
    // Comparisons that a NaN fails: nothing but finite values passes.
    if (!(e > T(-1) && e < T(1e6) && fastest < T(1e18))) mine.unsound = 1;
    mine.fastest = max(mine.fastest, double(fastest));
    if (account) mine.lost += double(lost * particles.mass(p) / (law.density * (T(1) + e)));
  }

  /// Adds what the team's threads found to the step's report; most teams find the largest values already there.
  JAXMPM_INLINE void give_report(const Team<Space>& team, const ThreadReport& mine) const {
    const double fastest = team_max(team, mine.fastest), displacement = team_max(team, mine.displacement);
    const double unsound = team_max(team, mine.unsound), lost = account ? team_sum(team, mine.lost) : 0.0;
    if (team.team_rank() != 0) return;
    const auto raise = [&](int at, double value) {
      if (value > report[at]) Kokkos::atomic_fetch_max(report + at, value);
    };
    raise(StepReport::fastest, fastest), raise(StepReport::displacement, displacement), raise(StepReport::unsound, unsound);
    if (account)
      Kokkos::atomic_add(report + (Law::template plastic_strain_index<Dim>() >= 0 ? StepReport::plastic : StepReport::viscous), lost);
  }
};

}  // namespace jaxmpm
