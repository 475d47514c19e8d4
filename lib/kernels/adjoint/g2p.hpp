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
JAXMPM_INLINE void update_particles_adjoint(const ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                            const Pack<typename Sch::T, batch<typename Sch::T>>* gathered,
                                            const MaterialAdjoint<typename Sch::T, Sch::Dim>& material,
                                            const StepConstants<typename Sch::T>& step, const DomainBounds<Sch::Dim>& domain,
                                            ParticleView<typename Sch::T, Sch::Dim>& bar,
                                            Pack<typename Sch::T, batch<typename Sch::T>>* bars, AdjointReport& report) {
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
      average_volume<Dim>(p.dilation[0].data() + s, count, gathered[G::theta], step.volume_averaging, H);
    }
  material.update(p, s, count, H, step.dt, bar, by_H, report.material);
  if constexpr (Sch::dilation)
    if (!p.dilation.empty()) {
      P by_trace(T(0));
      for (int c = 0; c < Dim; ++c) by_trace += P::load(by_H[c * (Dim + 1)]);
      const P by_mean = P(step.volume_averaging / T(Dim)) * by_trace;
      bars[G::theta] = by_mean;
      store(bar.dilation[0].data() + s, -by_mean, count);
    }
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) by(from + k, c) += rate * (P::load(by_H[c * Dim + k]) + (c == k ? by_next : P(T(0))));
}

/// Adjoint of g2p_tile, a batch after the other. The arena is cleared and receives the derivatives by the nodes, once all batches are done.
template <class Sch>
class G2pAdjoint {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  using Contract = NodeContraction<Sch, false>;
  using Stencil = typename Contract::template GatherStencil<Sch::g2p_moments, Sch::g2p_slopes>;
  static constexpr int Dim = Sch::Dim, W = batch<T>;

 public:
  /// What a batch gathered in the step.
  struct Batch {
    Stencil t;
    Pack<T, W> gathered[G::padded];
    typename Contract::template Sums<Stencil, G> sums;
    Batch(const ParticleView<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin) : t(p, s, count, origin) {}
  };

  /// `velocities`: what the tile gathered from.
  G2pAdjoint(const MaterialAdjoint<T, Dim>& material, const StepConstants<T>& step, const Index<Dim>& origin,
             const DomainBounds<Dim>& domain, const Nodes<Sch, false>& velocities, T* arena)
      : material_(material), step_(step), origin_(origin), domain_(domain), velocities_(velocities), bars_(arena) {}

  /// Gathers again for `count` particles from s, whose state at the start of the step is p.
  template <class Count>
  JAXMPM_ONCE Batch gather(const ParticleView<T, Dim>& p, std::size_t s, Count count) {
    Batch batch(p, s, count, origin_);
    velocities_.template gather<G>(batch.t, count, batch.gathered, batch.sums);
    return batch;
  }

  template <class Count>
  JAXMPM_ONCE void reverse(Batch& batch, const ParticleView<T, Dim>& p, std::size_t s, Count count, ParticleView<T, Dim>& bar,
                           AdjointReport& report) {
    Pack<T, W> bars[G::padded];
    for (auto& b : bars) b = Pack<T, W>(T(0));
    update_particles_adjoint<Sch>(p, s, count, batch.gathered, material_, step_, domain_, bar, bars, report);
    velocities_.template add_by_place<G>(batch.t, s, count, bars, batch.sums, bar);
    bars_.add(batch.t, count, ParticleValues<Sch, G>(bars));
  }

  /// Once all batches are done.
  void finish() { bars_.finish(); }

 private:
  const MaterialAdjoint<T, Dim>& material_;
  const StepConstants<T>& step_;
  const Index<Dim>& origin_;
  const DomainBounds<Dim>& domain_;
  Contract velocities_;
  Scatter<Sch, false> bars_;
};

/// Adjoint of grid to particles for particles [begin, end).
template <class Sch>
void g2p_adjoint_tile(const ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end, G2pAdjoint<Sch> g2p,
                      ParticleView<typename Sch::T, Sch::Dim>& bar, AdjointReport& report) {
  for_each_batch<typename Sch::T>(begin, end, [&](std::size_t s, auto count) {
    auto batch = g2p.gather(p, s, count);
    g2p.reverse(batch, p, s, count, bar, report);
  });
  g2p.finish();
}

/// Adjoint of particles to grid in a step, and then of grid to particles in the step before it: `p` is the state in between, `before` that at
/// the start of the earlier step. What `p` moves with is gathered again, and need not have been kept.
template <class Sch>
void between_steps_adjoint_tile(ParticleView<typename Sch::T, Sch::Dim>& p, const ParticleView<typename Sch::T, Sch::Dim>& before,
                                std::size_t begin, std::size_t end, P2gAdjoint<Sch> p2g, G2pAdjoint<Sch> g2p,
                                const StepConstants<typename Sch::T>& earlier, ParticleView<typename Sch::T, Sch::Dim>& bar,
                                MaterialReport& p2g_report, AdjointReport& g2p_report) {
  using G = GatheredGroups<Sch>;
  static_assert(!Sch::flip && !Sch::dilation, "what they move with is not all gathered");
  for_each_batch<typename Sch::T>(begin, end, [&](std::size_t s, auto count) {
    auto batch = g2p.gather(before, s, count);
    for (int c = 0; c < Sch::Dim; ++c) store(p.velocity[std::size_t(c)].data() + s, batch.gathered[G::component(G::value, c)], count);
    store_affine<Sch>(p, s, count, batch.gathered, earlier);
    p2g.reverse(p, s, count, bar, p2g_report);
    g2p.reverse(batch, before, s, count, bar, g2p_report);
  });
  g2p.finish();
}

}  // namespace jaxmpm
