#pragma once
// Adjoint of the transfer from grid to particles and of the stress update that follows: the reverse of a gather is a scatter.
#include "kernels/adjoint/p2g.hpp"

namespace jaxmpm {

/// What a tile reports of the adjoint of a step.
struct AdjointReport {
  MaterialReport material;
  double flip_fraction = 0;
};

/// Adjoint of update_particles for W particles: derivatives by their end values in `bar` become those by their start values as far as they
/// do not pass the grid, and those by what was gathered are written to `bars`, in the order of GatheredGroups.
template <class Sch>
JAXMPM_INLINE void update_particles_adjoint(const Particles<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                            const Pack<typename Sch::T, batch<typename Sch::T>>* gathered,
                                            const MaterialAdjoint<typename Sch::T, Sch::Dim>& material,
                                            const StepConstants<typename Sch::T>& step, const DomainBounds<Sch::Dim>& domain,
                                            Particles<typename Sch::T, Sch::Dim>& bar, Pack<typename Sch::T, batch<typename Sch::T>>* bars,
                                            AdjointReport& report) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  constexpr int W = batch<T>, Dim = Sch::Dim;
  using P = Pack<T, W>;
  const auto component = [&](int group, int c) { return gathered[G::component(group, c)]; };
  const auto by = [&](int group, int c) -> P& { return bars[G::component(group, c)]; };

  for (int c = 0; c < Dim; ++c) {  // x ← x + Δt v, and the velocity
    const P per_cell(step.dt / step.cell_size);
    const P by_x = drop_held(p.position[std::size_t(c)].data() + s, count, per_cell * component(G::value, c), domain[std::size_t(c)],
                             bar.position[std::size_t(c)].data() + s);
    T* by_v = bar.velocity[std::size_t(c)].data() + s;
    const P end = load(by_v, count);
    by(G::value, c) = per_cell * by_x;
    if constexpr (Sch::flip) {
      const P blend(step.flip_fraction), pic = component(G::value, c);
      by(G::value, c) += (P(T(1)) - blend) * end;
      by(G::change, c) = blend * end;
      const P share = end * (load(p.velocity[std::size_t(c)].data() + s, count) + component(G::change, c) - pic);
      report.flip_fraction += sum_of(share, count);
      store(by_v, blend * end, count);
    } else {
      by(G::value, c) += end;
      store(by_v, P(T(0)), count);
    }
  }
  if constexpr (Sch::affine) {
    constexpr int from = Sch::affine_by_moments ? G::moments : G::slopes;
    const P scale(Sch::affine_scale / step.cell_size);
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        T* by_affine = bar.affine[std::size_t(c * Dim + k)].data() + s;
        by(from + k, c) += scale * load(by_affine, count);
        store(by_affine, P(T(0)), count);
      }
  }
  constexpr int from = Sch::mls ? G::moments : G::slopes;
  const P rate(step.dt * (Sch::gradient_scale / step.cell_size));
  alignas(64) T H[Dim * Dim][W], by_H[Dim * Dim][W];
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) (rate * component(from + k, c)).store(H[c * Dim + k]);
  P by_next(T(0));  // by tr H, through the next step
  if constexpr (Sch::dilation)
    if (!p.dilation.empty()) {
      by_next = load(bar.dilation[0].data() + s, count);
      average_volume(p, s, count, gathered[G::dilation], step.volume_averaging, H);
    }
  material.update(p, s, count, H, step.dt, bar, by_H, report.material);
  if constexpr (Sch::dilation)
    if (!p.dilation.empty()) {
      P by_trace(T(0));
      for (int c = 0; c < Dim; ++c) by_trace += P::load(by_H[c * (Dim + 1)]);
      const P by_mean = P(step.volume_averaging / T(Dim)) * by_trace;
      bars[G::dilation] = by_mean;
      store(bar.dilation[0].data() + s, -by_mean, count);
    }
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) by(from + k, c) += rate * (P::load(by_H[c * Dim + k]) + (c == k ? by_next : P(T(0))));
}

/// Adjoint of g2p_tile. `velocities`: the arena that the tile gathered from; `arena` is cleared and receives the derivatives by it.
template <class Sch>
void g2p_adjoint_tile(const Particles<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end,
                      const MaterialAdjoint<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step,
                      const Index<Sch::Dim>& origin, const DomainBounds<Sch::Dim>& domain, const typename Sch::T* velocities,
                      typename Sch::T* arena, Particles<typename Sch::T, Sch::Dim>& bar, AdjointReport& report) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  using Rows = StencilRows<Sch, false>;
  using R = typename Rows::R;
  constexpr int W = batch<T>;
  constexpr int moments = Sch::g2p_moments ? G::moments : -1, slopes = Sch::g2p_slopes ? G::slopes : -1;
  std::memset(arena, 0, sizeof(T) * Sch::arena_size);
  Rows rows[Sch::planes], by_rows[Sch::planes];
  for (auto& r : rows) r.clear();
  for (auto& r : by_rows) r.clear();
  int current = -1, loaded = -1;  // base nodes of by_rows and of rows
  const auto flush = [&] {
    for (int plane = 0; plane < Sch::planes; ++plane) by_rows[plane].add_to(arena + plane * Sch::arena_plane + current * 4);
  };
  for_each_batch<T>(begin, end, [&](std::size_t s, int count) JAXMPM_INLINE_LAMBDA {
    const Stencils<Sch, Sch::g2p_moments, Sch::g2p_slopes, true> t(p, s, count, origin);
    ParticleRows<T, G::V * G::padded> gathered;
    gather_batch<Sch>(t, count, velocities, rows, loaded, gathered);
    Pack<T, W> packs[decltype(gathered)::stride], bars[decltype(gathered)::stride];
    gathered.read(packs);
    for (auto& b : bars) b = Pack<T, W>(T(0));
    update_particles_adjoint<Sch>(p, s, count, packs, material, step, domain, bar, bars, report);
    gathered.fill(bars);

    PlaceSums<Sch> by_place;
    for (int l = 0; l < count; ++l) {
      if (t.base[l] != current) {
        if (current >= 0) flush();
        for (auto& r : by_rows) r.clear();
        current = t.base[l];
      }
      if (t.base[l] != loaded) {
        loaded = t.base[l];
        for (int plane = 0; plane < Sch::planes; ++plane) rows[plane].load(velocities + plane * Sch::arena_plane + loaded * 4);
      }
      R place[PlaceSums<Sch>::padded];
      for (R& x : place) x = R(T(0));
      scatter<Sch, G::value, moments, slopes>(by_rows[0], t, l, gathered.row(l));
      contract<Sch, G::value, moments, slopes>(rows[0], t, l, gathered.row(l), place, nullptr);
      if constexpr (Sch::planes == 2) {
        scatter<Sch, G::change, -1, -1>(by_rows[1], t, l, gathered.row(l));
        contract<Sch, G::change, -1, -1>(rows[1], t, l, gathered.row(l), place, nullptr);
      }
      by_place.put(l, place);
    }
    by_place.add_to(bar, s, count);
  });
  if (current >= 0) flush();
}

}  // namespace jaxmpm
