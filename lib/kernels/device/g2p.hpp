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

/// Hands a step's report to the host and begins the next one's.
struct PublishReport {
  double *report, *published;
  JAXMPM_INLINE void operator()(std::size_t) const {
    for (int k = 0; k < StepReport::size; ++k) published[k] = report[k], report[k] = 0;
  }
};

/// One thread's share of it.
template <class T>
struct ThreadReport {
  T fastest = 0, displacement = 0;
  double lost = 0;
  bool unsound = false;
};

/// What turns sums over nodes into movements (cells), the affine field and the velocity gradient (1/s).
template <class Sch>
struct GatherScales {
  using T = typename Sch::T;
  T move, affine, gradient;
  explicit JAXMPM_INLINE GatherScales(const StepConstants<T>& step)
      : move(step.dt / step.cell_size), affine(Sch::affine_scale / step.cell_size), gradient(Sch::gradient_scale / step.cell_size) {}
};

/// Σ over a particle's stencil of factor × node, of `count` values of a plane's records from value `first` on.
template <class Sch, bool with_d, bool with_g, int first, int count>
struct PlaneSums {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  T value[count];                             // Σ w q
  T moments[Dim][count], slopes[Dim][count];  // [axis] Σ d q, Σ g q

  /// `base`: the stencil's first node in the arena.
  JAXMPM_INLINE PlaneSums(const Factors<Sch>& s, int base, const T* arena) {
    constexpr int last = Dim - 1;
    for (int c = 0; c < count; ++c) {
      value[c] = T(0);
      for (int k = 0; k < Dim; ++k) moments[k][c] = slopes[k][c] = T(0);
    }
    JAXMPM_UNROLL
    for (int r = 0; r < StencilNodes<Sch>::rows; ++r) {
      const auto row = s.row(r);
      T w[count] = {}, d[count] = {}, g[count] = {};  // sums along the row
      JAXMPM_UNROLL
      for (int a = 0; a < Sch::S; ++a) {
        const Quad<T> q = quad_at(arena, base + StencilNodes<Sch>::at(r * Sch::S) + a);
        for (int c = 0; c < count; ++c) {
          w[c] += s.w[last][a] * q.a[first + c];
          if constexpr (with_d) d[c] += s.d[last][a] * q.a[first + c];
          if constexpr (with_g) g[c] += s.g[last][a] * q.a[first + c];
        }
      }
      for (int c = 0; c < count; ++c) {
        value[c] += row.w * w[c];
        for (int k = 0; k < last; ++k) {
          if constexpr (with_d) moments[k][c] += row.d[k] * w[c];
          if constexpr (with_g) slopes[k][c] += row.g[k] * w[c];
        }
        if constexpr (with_d) moments[last][c] += row.w * d[c];
        if constexpr (with_g) slopes[last][c] += row.w * g[c];
      }
    }
  }
};

/// What a step gathers: velocities and, with FLIP, their changes.
template <class Sch>
struct Gathered : PlaneSums<Sch, Sch::g2p_moments, Sch::g2p_slopes, 1, Sch::Dim> {
  using T = typename Sch::T;
  T change[Sch::Dim];  // Σ w Δv

  JAXMPM_INLINE Gathered(const Factors<Sch>& s, int base, const T* arena)
      : PlaneSums<Sch, Sch::g2p_moments, Sch::g2p_slopes, 1, Sch::Dim>(s, base, arena) {
    if constexpr (Sch::flip) {
      const PlaneSums<Sch, false, false, 1, Sch::Dim> second(s, base, arena + Sch::arena_plane);
      for (int c = 0; c < Sch::Dim; ++c) change[c] = second.value[c];
    }
  }
};

template <class Sch, class Law, class Space>
struct GatherTiles {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  static constexpr std::size_t scratch = Sch::arena_size * sizeof(T) + 16;
  static constexpr int threads = 128, resident = sizeof(T) == 4 ? 4 : 3;
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
    const GatherScales<Sch> scales(step);
    ThreadReport<T> mine;
    std::size_t p = tile.begin + std::size_t(team.team_rank());
    Position<Dim> ahead;  // is read one particle ahead of its use
    if (p < tile.end) ahead = Position<Dim>(particles, p);
    load_arena<Sch>(team, neighbour + std::size_t(tile.block) * Sch::Shape::neighbours, grid, arena);
    team.team_barrier();
    while (p < tile.end) {
      const State state(particles, p, ahead);
      p += std::size_t(team.team_size());
      if (p < tile.end) ahead = Position<Dim>(particles, p);
      const Cell<Sch> cell(state.at, origin);
      update(state, Gathered<Sch>(Factors<Sch>(cell.offset), cell.base, arena), scales, mine);
    }
    give_report(team, mine);
  }

 private:
  /// What a particle has before the step: read at once, as the compiler keeps reads behind the writes that come before them in the text.
  struct State {
    static constexpr int history = Law::template history_size<Dim>();
    std::size_t p;
    Position<Dim> at;
    T velocity[Dim], e, h[history > 0 ? history : 1];

    JAXMPM_INLINE State(const ParticleFields<T, Dim>& f, std::size_t particle, const Position<Dim>& position)
        : p(particle), at(position), e(f.compression(p)) {
      for (int c = 0; c < Dim; ++c)
        if constexpr (Sch::flip) velocity[c] = f.velocity(c, p);
      for (int k = 0; k < history; ++k) h[k] = f.history(k, p);
    }
  };

  /// Moves a particle and advances its material.
  JAXMPM_INLINE void update(State state, const Gathered<Sch>& sum, const GatherScales<Sch>& per, ThreadReport<T>& mine) const {
    const std::size_t p = state.p;
    T speed2 = T(0);
    for (int c = 0; c < Dim; ++c) {
      const T pic = sum.value[c];
      T v = pic;
      if constexpr (Sch::flip) v = step.flip_fraction * (state.velocity[c] + sum.change[c]) + (T(1) - step.flip_fraction) * pic;
      particles.velocity(c, p) = v;
      speed2 += v * v;
      const T move = per.move * pic;
      mine.displacement = max(mine.displacement, abs(move));
      const double X = state.at.X[c] + double(move), last = cells[std::size_t(c)];
      const bool held = X >= -held_within && X <= last + held_within;
      particles.position(c, p) = held ? min(max(X, 0.0), last) : X;
      if (!held) mine.unsound = true;
    }
    Matrix<T, Dim> H;
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        if constexpr (Sch::affine)
          particles.affine(c * Dim + k, p) = per.affine * (Sch::affine_by_moments ? sum.moments : sum.slopes)[k][c];
        const T gradient = per.gradient * (Sch::mls ? sum.moments : sum.slopes)[k][c];
        H(c, k) = step.dt * gradient;
        if (particles.first_gradient >= 0) particles.gradient(c * Dim + k, p) = gradient;
      }
    advance(state, H, sqrt(speed2), mine);
  }

  JAXMPM_INLINE void advance(State& state, const Matrix<T, Dim>& H, T speed, ThreadReport<T>& mine) const {
    const std::size_t p = state.p;
    T& e = state.e;
    const T lost = law.template update<T, Dim>(H, step.dt, e, state.h);
    particles.compression(p) = e;
    for (int k = 0; k < State::history; ++k) particles.history(k, p) = state.h[k];
    const T fastest = law.template wave_speed<T, Dim>(e, state.h) + speed;
    // Comparisons that a NaN fails: nothing but finite values passes.
    if (!(e > T(-1) && e < T(1e6) && fastest < T(1e18))) mine.unsound = true;
    mine.fastest = max(mine.fastest, fastest);
    if (account) mine.lost += double(lost * particles.mass(p) / (law.density * (T(1) + e)));
  }

  /// Adds what the team's threads found to the step's report; most warps find the largest values already there.
  JAXMPM_INLINE void give_report(const Team<Space>& team, const ThreadReport<T>& mine) const {
    const T fastest = warp_max(mine.fastest), displacement = warp_max(mine.displacement);
    if (mine.unsound) report[StepReport::unsound] = 1;
    const auto raise = [&](int at, double value) {
      if (value > report[at]) Kokkos::atomic_fetch_max(report + at, value);
    };
    if (leads_warp(team)) raise(StepReport::fastest, double(fastest)), raise(StepReport::displacement, double(displacement));
    if (!account) return;
    const double lost = team_sum(team, mine.lost);
    if (team.team_rank() == 0)
      Kokkos::atomic_add(report + (Law::template plastic_strain_index<Dim>() >= 0 ? StepReport::plastic : StepReport::viscous), lost);
  }
};

}  // namespace jaxmpm
