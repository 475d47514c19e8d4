#pragma once
// Grid to particles (Eqs 15–18, B.1, B.2) and the stress that follows from it: one tile gathers from its arena, moves its particles and
// advances its material.
#include "kernels/p2g.hpp"

namespace jaxmpm {

/// Where what a particle gathers lies: groups of V values, as a node gives them, and in 2D the mean of θ by itself.
template <class Sch>
struct GatheredGroups {
  static constexpr int V = Sch::V, value = 0, moments = 1, slopes = Sch::g2p_moments ? 1 + Sch::Dim : 1;
  static constexpr int change = 1 + Sch::Dim * (int(Sch::g2p_moments) + int(Sch::g2p_slopes));  // the second plane: FLIP's Σ φ Δv
  static constexpr int ends = change + Sch::planes - 1;
  static constexpr int mass = -1;
  static constexpr int theta = !Sch::dilation ? -1 : (Sch::Dim == 3 ? V * change + Sch::dilation_lane : V * ends);
  static constexpr int size = V * ends + int(Sch::Dim == 2 && Sch::dilation);
  static constexpr int padded = round_up(size, batch<typename Sch::T>);
  static constexpr int component(int group, int c) { return V * group + Sch::vector_at + c; }
  static constexpr PlaneTerms in_plane(int plane) {
    if (plane > 0) return {change, -1, -1};
    return {value, Sch::g2p_moments ? moments : -1, Sch::g2p_slopes ? slopes : -1};
  }
};

/// tr H += part (θ̄ − θ): takes part of the last step's change of volume θ back and puts the mean of the nodes around in its place. Returns
/// tr H as it was.
template <int Dim, class T>
JAXMPM_INLINE Pack<T, batch<T>> average_volume(const T* theta, int count, Pack<T, batch<T>> mean, T part, T H[][batch<T>]) {
  using P = Pack<T, batch<T>>;
  const P share = P(part / T(Dim)) * (mean - load(theta, count));
  P trace(T(0));
  for (int c = 0; c < Dim; ++c) {
    const P along = P::load(H[c * (Dim + 1)]);
    trace += along, (along + share).store(H[c * (Dim + 1)]);
  }
  return trace;
}

/// The affine field that follows from what was gathered.
template <class Sch>
JAXMPM_INLINE void store_affine(ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
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
JAXMPM_INLINE void update_particles(ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
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
      store(p.dilation[0].data() + s, average_volume<Dim>(p.dilation[0].data() + s, count, gathered[G::theta], step.volume_averaging, H),
            count);
  sqrt(speed2).store(speed);
  material.update(p, s, count, H, speed, step.dt, account, report);
  report.displacement = std::max(report.displacement, double(largest(moved)));
}

/// Gathers to particles [begin, end) of a body from the nodes around them and advances their material. `origin`: node 0 of the arena.
template <class Sch>
TileReport g2p_tile(ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end,
                    const MaterialKernel<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step, bool account,
                    const Index<Sch::Dim>& origin, const DomainBounds<Sch::Dim>& domain, const Nodes<Sch, false>& around) {
  using T = typename Sch::T;
  using G = GatheredGroups<Sch>;
  Gather<Sch> nodes(around);
  TileReport report;
  for_each_batch<T>(begin, end, [&](std::size_t s, int count) JAXMPM_INLINE_LAMBDA {
    const Stencils<Sch, Sch::g2p_moments, Sch::g2p_slopes> t(p, s, count, origin);
    Pack<T, batch<T>> gathered[G::padded];
    nodes.template gather<G>(t, count, gathered);
    update_particles<Sch>(p, s, count, gathered, material, step, account, domain, report);
  });
  return report;
}

}  // namespace jaxmpm
