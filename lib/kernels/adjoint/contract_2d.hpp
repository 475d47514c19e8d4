#pragma once
// contract.hpp in 2D.
#include "kernels/gather_2d.hpp"

namespace jaxmpm {

/// Gathers from the nodes around a tile and finds the derivatives of what is gathered by the particles' places.
template <class Sch, bool Masses>
class Contraction2d {
  using T = typename Sch::T;
  static constexpr int W = batch<T>;

 public:
  explicit Contraction2d(const Nodes2d<Sch, Masses>& nodes) : nodes_(nodes) {}

  /// The stencils that contract() works on, and those of gather(), from which the same values are scattered.
  template <bool moments, bool slopes>
  using ContractStencil = Stencils2d<Sch, moments, slopes, true>;
  template <bool moments, bool slopes>
  using GatherStencil = ContractStencil<moments, slopes>;
  /// What a gather leaves for the derivatives by place.
  template <class Stencil, class Bars>
  using Sums = GatheredSums<Sch, Stencil, Bars, Masses, true>;

  /// What the stencils t find in the nodes, in the groups of Bars.
  template <class Bars, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int, Pack<T, W>* gathered, Sums<Stencil, Bars>& sums) {
    sums.sum(t, nodes_);
    sums.store(gathered);
  }

  /// Adds ∂f/∂X to the derivatives by the places of `count` particles from s.
  template <class Terms, class Stencil, class Bars>
  JAXMPM_INLINE void add_by_place(const Stencil&, std::size_t s, int count, const Pack<T, W>* values, Sums<Stencil, Bars>& sums,
                                  ParticleView<T, 2>& bar) {
    Pack<T, W> by[2] = {Pack<T, W>(T(0)), Pack<T, W>(T(0))};
    sums.add_by_place(Values2d<T, Terms>(values), by);
    for (int j = 0; j < 2; ++j) add_to_places(bar.position[std::size_t(j)].data() + s, count, by[j]);
  }

  /// Both.
  template <class Bars, class Terms, class Stencil>
  JAXMPM_INLINE void contract(const Stencil& t, std::size_t s, int count, const Pack<T, W>* values, Pack<T, W>* gathered,
                              ParticleView<T, 2>& bar) {
    Sums<Stencil, Bars> sums;
    gather<Bars>(t, count, gathered, sums);
    add_by_place<Terms>(t, s, count, values, sums, bar);
  }

 private:
  const Nodes2d<Sch, Masses>& nodes_;
};

}  // namespace jaxmpm
