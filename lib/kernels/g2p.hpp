#pragma once
// Grid to particles (Eqs 15–18, B.1, B.2) and the stress that follows from it: one tile gathers from its arena, moves its particles and
// advances its material.
#include "kernels/p2g.hpp"

namespace jaxmpm {

/// Where what a particle gathers lies in its row: groups of V values, as a node gives them.
template <class Sch>
struct GatheredGroups {
  static constexpr int V = Sch::V, value = 0, moments = 1, slopes = Sch::g2p_moments ? 1 + Sch::Dim : 1;
  static constexpr int change = 1 + Sch::Dim * (int(Sch::g2p_moments) + int(Sch::g2p_slopes));  // the second plane: FLIP's Σ φ Δv
  static constexpr int count = change + Sch::planes - 1;
  static constexpr int dilation = V * (Sch::dilation_plane == 0 ? value : change) + Sch::dilation_lane;  // where the mean of θ is
  static constexpr int per_store = RowShape<typename Sch::T, Sch::S, V>::N / V;
  static constexpr int padded = (count + per_store - 1) / per_store * per_store;
  static constexpr int component(int group, int c) { return V * group + Sch::vector_at + c; }
};

/// The end of a gather: part c of the rows along the last axis (factors z), whose nodes have been summed over the other axes with w (`sum`)
/// and with d or g on each of them in turn. Adds to the sums of the parts before; the first one sets them.
template <class Sch, int c, bool moments, bool slopes, class Stencil, class R>
JAXMPM_INLINE void gather_last_axis(const typename Sch::T* z, const R& sum, const R* d, const R* g, R* sums) {
  constexpr int N = R::lanes, V = Sch::V, last = Sch::Dim - 1, first_moment = 1, first_slope = moments ? 1 + Sch::Dim : 1;
  const auto put = [&](int group, R value) { sums[group] = c == 0 ? value : sums[group] + value; };
  const R w = spread<V, Stencil::w_quad, c, N>(z);
  put(0, sum * w);
  if constexpr (moments) {
    for (int k = 0; k < last; ++k) put(first_moment + k, d[k] * w);
    put(first_moment + last, sum * spread<V, Stencil::d_quad, c, N>(z));
  }
  if constexpr (slopes) {
    for (int k = 0; k < last; ++k) put(first_slope + k, g[k] * w);
    put(first_slope + last, sum * spread<V, Stencil::g_quad, c, N>(z));
  }
}

/// Σ over the stencil of factor × node, for one particle: groups of sums (the value, then Dim with moments, then Dim with slopes), one pack
/// per (group, lane of the row); still to be added along the row.
template <class Sch, bool moments, bool slopes, class Stencil>
JAXMPM_INLINE void gather(const StencilRows<Sch, false>& rows, const Stencil& t, int l, typename StencilRows<Sch, false>::R* sums) {
  using T = typename Sch::T;
  using Row = typename StencilRows<Sch, false>::Row;
  constexpr int S = Sch::S, N = Row::N;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    R sum(T(0)), d[2] = {R(T(0)), R(T(0))}, g[2] = {R(T(0)), R(T(0))};  // Σ w, and with d or g on one axis but the last
    for (int a = 0; a < S; ++a) {
      R line(T(0));
      if constexpr (Sch::Dim == 2) {
        line = rows.row[a][c];
      } else {
        R dy(T(0)), gy(T(0));
        for (int b = 0; b < S; ++b) {
          const R& x = rows.row[a * S + b][c];
          line += R(t.w[1][b][l]) * x;
          if constexpr (moments) dy += R(t.d[1][b][l]) * x;
          if constexpr (slopes) gy += R(t.g[1][b][l]) * x;
        }
        const R wx(t.w[0][a][l]);
        if constexpr (moments) d[1] += wx * dy;
        if constexpr (slopes) g[1] += wx * gy;
      }
      sum += R(t.w[0][a][l]) * line;
      if constexpr (moments) d[0] += R(t.d[0][a][l]) * line;
      if constexpr (slopes) g[0] += R(t.g[0][a][l]) * line;
    }
    gather_last_axis<Sch, c, moments, slopes, Stencil>(z, sum, d, g, sums);
  });
}

/// Gathers for `count` particles (those of the stencils t), in the order of GatheredGroups; lanes behind them repeat the last. `rows` holds the
/// stencil of base node `loaded` from particle to particle, and from batch to batch.
template <class Sch, class Stencil>
JAXMPM_INLINE void gather_batch(const Stencil& t, int count, const typename Sch::T* arena, StencilRows<Sch, false>* rows, int& loaded,
                                ParticleRows<typename Sch::T, Sch::V * GatheredGroups<Sch>::padded>& gathered) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  using R = typename StencilRows<Sch, false>::R;
  for (int l = 0; l < count; ++l) {
    load_rows(rows, arena, t.base[l], loaded);
    R sums[G::padded];
    for (int i = G::count; i < G::padded; ++i) sums[i] = R(T(0));
    gather<Sch, Sch::g2p_moments, Sch::g2p_slopes>(rows[0], t, l, sums);
    if constexpr (Sch::planes == 2) gather<Sch, false, false>(rows[1], t, l, sums + G::change);
    for (int i = 0; i < G::padded; i += G::per_store) sum_groups<G::V>(sums + i).store(gathered.row(l) + G::V * i);
  }
  for (int l = count; l < batch<T>; ++l) std::memcpy(gathered.row(l), gathered.row(count - 1), sizeof(T) * std::size_t(G::V * G::padded));
}

/// tr H += part (θ̄ − θ): takes part of the last step's change of volume θ back and puts the mean of the nodes around in its place. Returns
/// tr H as it was.
template <class T, int Dim>
JAXMPM_INLINE Pack<T, batch<T>> average_volume(const Particles<T, Dim>& p, std::size_t s, int count, Pack<T, batch<T>> mean, T part,
                                               T H[][batch<T>]) {
  using P = Pack<T, batch<T>>;
  const P share = P(part / T(Dim)) * (mean - load(p.dilation[0].data() + s, count));
  P trace(T(0));
  for (int c = 0; c < Dim; ++c) {
    const P along = P::load(H[c * (Dim + 1)]);
    trace += along, (along + share).store(H[c * (Dim + 1)]);
  }
  return trace;
}

/// The affine field that follows from what was gathered.
template <class Sch>
JAXMPM_INLINE void store_affine(Particles<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                const Pack<typename Sch::T, batch<typename Sch::T>>* gathered, const StepConstants<typename Sch::T>& step) {
  using G = GatheredGroups<Sch>;
  if constexpr (Sch::affine) {
    constexpr int Dim = Sch::Dim, from = Sch::affine_by_moments ? G::moments : G::slopes;
    const Pack<typename Sch::T, batch<typename Sch::T>> scale(Sch::affine_scale / step.cell_size);
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k)
        store(p.affine[std::size_t(c * Dim + k)].data() + s, scale * gathered[G::component(from + k, c)], count);
  }
}

/// Moves W particles and advances their material.
template <class Sch>
JAXMPM_INLINE void update_particles(Particles<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                    const Pack<typename Sch::T, batch<typename Sch::T>>* gathered,
                                    const MaterialKernel<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step,
                                    bool account, const DomainBounds<Sch::Dim>& domain, TileReport& report) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  constexpr int W = batch<T>, Dim = Sch::Dim;
  using P = Pack<T, W>;
  const auto component = [&](int group, int c) { return gathered[G::component(group, c)]; };
  P speed2(T(0)), moved(T(0));
  for (int c = 0; c < Dim; ++c) {
    const P pic = component(G::value, c);
    P v = pic;
    if constexpr (Sch::flip) {
      const P blend(step.flip_fraction);
      v = blend * (load(p.velocity[std::size_t(c)].data() + s, count) + component(G::change, c)) + (P(T(1)) - blend) * pic;
    }
    store(p.velocity[std::size_t(c)].data() + s, v, count);
    speed2 += v * v;
    const P dX = P(step.dt / step.cell_size) * pic;
    moved = max(moved, abs(dX));
    if (!move_places(p.position[std::size_t(c)].data() + s, count, dX, domain[std::size_t(c)])) report.inside = false;
  }
  store_affine<Sch>(p, s, count, gathered, step);
  constexpr int from = Sch::mls ? G::moments : G::slopes;
  const P rate(Sch::gradient_scale / step.cell_size);
  alignas(64) T H[Dim * Dim][W], speed[W];
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) {
      const P gradient = rate * component(from + k, c);
      (P(step.dt) * gradient).store(H[c * Dim + k]);
      if (!p.gradient.empty()) store(p.gradient[std::size_t(c * Dim + k)].data() + s, gradient, count);
    }
  if constexpr (Sch::dilation)
    if (!p.dilation.empty())
      store(p.dilation[0].data() + s, average_volume(p, s, count, gathered[G::dilation], step.volume_averaging, H), count);
  sqrt(speed2).store(speed);
  material.update(p, s, count, H, speed, step.dt, account, report);
  report.displacement = std::max(report.displacement, double(largest(moved)));
}

/// Gathers to particles [begin, end) of a body from `arena` and advances their material. `origin`: node 0 of the arena.
template <class Sch>
TileReport g2p_tile(Particles<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end,
                    const MaterialKernel<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step, bool account,
                    const Index<Sch::Dim>& origin, const DomainBounds<Sch::Dim>& domain, const typename Sch::T* arena) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  constexpr int W = batch<T>;
  StencilRows<Sch, false> rows[Sch::planes];
  for (auto& r : rows) r.clear();
  int current = -1;
  TileReport report;
  for_each_batch<T>(begin, end, [&](std::size_t s, int count) JAXMPM_INLINE_LAMBDA {
    const Stencils<Sch, Sch::g2p_moments, Sch::g2p_slopes> t(p, s, count, origin);
    ParticleRows<T, G::V * G::padded> gathered;
    gather_batch<Sch>(t, count, arena, rows, current, gathered);
    Pack<T, W> packs[decltype(gathered)::stride];
    gathered.read(packs);
    update_particles<Sch>(p, s, count, packs, material, step, account, domain, report);
  });
  return report;
}

}  // namespace jaxmpm
