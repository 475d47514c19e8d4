#pragma once
#include "kernels/g2p.hpp"
#include "kernels/step_kernels.hpp"

namespace jaxmpm {

template <class Sch>
TileReport gather_tile(ParticleView<typename Sch::T, Sch::Dim>& p, const Tile& tile, const Blocks<Sch::Dim>& blocks,
                       const typename Sch::T* grid, const MaterialKernel<typename Sch::T, Sch::Dim>& material,
                       const StepConstants<typename Sch::T>& step, bool account, const Index<Sch::Dim>& origin,
                       const DomainBounds<Sch::Dim>& domain) {
  const Nodes<Sch, false> nodes(blocks, tile.block, grid);
  return g2p_tile<Sch>(p, tile.begin, tile.end, material, step, account, origin, domain, nodes);
}

template <class Sch>
StepKernels<typename Sch::T, Sch::Dim> kernels_of() {
  using T = typename Sch::T;
  constexpr int Dim = Sch::Dim, S = Sch::S;
  StepKernels<T, Dim> k;
  k.base_shift = Bspline<S>::base_shift, k.planes = Sch::planes;
  k.arena_size = Sch::arena_size, k.own_size = Sch::own_size;
  k.block_extent = &block_extent<Dim, S>;
  k.sort = &sort_particles<S, T, Dim>;
  k.build_blocks = &build_blocks<S, Dim>;
  k.p2g = &p2g_tile<Sch>;
  k.sum = &sum_arenas<Sch>;
  k.update_nodes = &update_nodes<Sch>;
  k.g2p = &gather_tile<Sch>;
  return k;
}

/// Calls f(Scheme<…>{}) with the scheme of a method: the one place where run-time choices become compile-time facts.
template <class T, int Dim, int S, bool mls, bool dilation, class F>
auto with_scheme(deck::Transfer transfer, F&& f) {
  using deck::Transfer;
  switch (transfer) {
    case Transfer::pic:
      return f(Scheme<T, Dim, S, Transfer::pic, mls, dilation>{});
    case Transfer::flip:
      return f(Scheme<T, Dim, S, Transfer::flip, mls, dilation>{});
    case Transfer::apic:  // with linear splines APIC is TPIC
      if constexpr (S > 2) return f(Scheme<T, Dim, S, Transfer::apic, mls, dilation>{});
      [[fallthrough]];
    case Transfer::tpic:
      break;
  }
  return f(Scheme<T, Dim, S, Transfer::tpic, mls, dilation>{});
}

template <class T, int Dim, int S, bool dilation, class F>
auto with_scheme(const deck::Method& method, F&& f) {
  if constexpr (S > 2)
    if (method.gradient == deck::GradientForm::mls) return with_scheme<T, Dim, S, true, dilation>(method.transfer, f);
  return with_scheme<T, Dim, S, false, dilation>(method.transfer, f);
}

template <class T, int Dim, int S, class F>
auto with_scheme(const deck::Method& method, F&& f) {
  return method.volume_averaging > 0 ? with_scheme<T, Dim, S, true>(method, f) : with_scheme<T, Dim, S, false>(method, f);
}

template <class T, int Dim, int S>
StepKernels<T, Dim> step_kernels(const deck::Method& method) {
  return with_scheme<T, Dim, S>(method, [](auto scheme) { return kernels_of<decltype(scheme)>(); });
}

}  // namespace jaxmpm
