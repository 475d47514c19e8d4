#pragma once
#include "kernels/adjoint/grid.hpp"
#include "kernels/adjoint/step_adjoint.hpp"
#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {

template <class Sch>
AdjointKernels<typename Sch::T, Sch::Dim> adjoint_kernels_of() {
  using T = typename Sch::T;
  constexpr int Dim = Sch::Dim;
  AdjointKernels<T, Dim> k;
  k.update_nodes = &update_nodes_adjoint<Sch>;
  k.g2p = [](const ParticleView<T, Dim>& p, const Tile& tile, const Blocks<Dim>& blocks, const T* grid,
             const MaterialAdjoint<T, Dim>& material, const StepConstants<T>& step, const Index<Dim>& origin,
             const DomainBounds<Dim>& domain, T* arena, ParticleView<T, Dim>& bar, AdjointReport& report) {
    const Nodes<Sch, false> velocities(blocks, tile.block, grid);
    g2p_adjoint_tile<Sch>(p, tile.begin, tile.end, {material, step, origin, domain, velocities, arena}, bar, report);
  };
  k.p2g = [](const ParticleView<T, Dim>& p, const Tile& tile, const Blocks<Dim>& blocks, const T* by_sums,
             const MaterialKernel<T, Dim>& material, const MaterialAdjoint<T, Dim>& adjoint, const StepConstants<T>& step,
             const Index<Dim>& origin, ParticleView<T, Dim>& bar, MaterialReport& report) {
    const Nodes<Sch, true> bars(blocks, tile.block, by_sums);
    p2g_adjoint_tile<Sch>(p, tile.begin, tile.end, {material, adjoint, step, origin, bars}, bar, report);
  };
  if constexpr (!Sch::flip && !Sch::dilation)
    k.between_steps = [](ParticleView<T, Dim>& p, const ParticleView<T, Dim>& before, const Tile& tile, const Blocks<Dim>& blocks,
                         const MaterialKernel<T, Dim>& material, const MaterialAdjoint<T, Dim>& adjoint, const Index<Dim>& origin,
                         const DomainBounds<Dim>& domain, T* arena, ParticleView<T, Dim>& bar,
                         const typename AdjointKernels<T, Dim>::Between& of) {
      const Nodes<Sch, false> velocities(blocks, tile.block, of.grid);
      const Nodes<Sch, true> by_sums(blocks, tile.block, of.by_sums);
      between_steps_adjoint_tile<Sch>(p, before, tile.begin, tile.end, {material, adjoint, of.after, origin, by_sums},
                                      {adjoint, of.before, origin, domain, velocities, arena}, of.before, bar, of.p2g, of.g2p);
    };
  return k;
}

template <class T, int Dim, int S>
AdjointKernels<T, Dim> adjoint_kernels(const deck::Method& method) {
  return with_scheme<T, Dim, S>(method, [](auto scheme) { return adjoint_kernels_of<decltype(scheme)>(); });
}

}  // namespace jaxmpm
