#pragma once
// The adjoint kernels of one scheme behind plain function pointers, beside StepKernels.
#include "kernels/adjoint/g2p.hpp"
#include "kernels/step_kernels.hpp"

namespace jaxmpm {

template <class T, int Dim>
struct AdjointKernels {
  Vector<T, Dim> (*update_nodes)(const T* raw, const GridConstants<T, Dim>&, T* own) = nullptr;
  /// Adjoint of g2p: `grid` holds the velocities of all blocks, `arena` receives the derivatives by the nodes that the tile saw.
  void (*g2p)(const ParticleView<T, Dim>&, const Tile&, const Blocks<Dim>&, const T* grid, const MaterialAdjoint<T, Dim>&,
              const StepConstants<T>&, const Index<Dim>& origin, const DomainBounds<Dim>&, T* arena, ParticleView<T, Dim>& bar,
              AdjointReport&) = nullptr;
  /// Adjoint of p2g: `by_sums` holds the derivatives by the sums of all blocks.
  void (*p2g)(const ParticleView<T, Dim>&, const Tile&, const Blocks<Dim>&, const T* by_sums, const MaterialKernel<T, Dim>&,
              const MaterialAdjoint<T, Dim>&, const StepConstants<T>&, const Index<Dim>& origin, ParticleView<T, Dim>& bar,
              MaterialReport&) = nullptr;
  /// Both, of a step (`after`) and of the one before it (`before`), as between_steps_adjoint_tile() does it; null where a step does not
  /// gather all that particles move with (FLIP, averaged volumes).
  struct Between {
    const StepConstants<T>&after, &before;
    const T *by_sums, *grid;  // derivatives by the sums of the later step, velocities of the earlier one
    MaterialReport& p2g;
    AdjointReport& g2p;
  };
  void (*between_steps)(ParticleView<T, Dim>&, const ParticleView<T, Dim>& before, const Tile&, const Blocks<Dim>&,
                        const MaterialKernel<T, Dim>&, const MaterialAdjoint<T, Dim>&, const Index<Dim>& origin, const DomainBounds<Dim>&,
                        T* arena, ParticleView<T, Dim>& bar, const Between&) = nullptr;
};

/// The adjoint kernels of a method. Defined per precision, dimension and spline in kernels/adjoint/adjoint_*.cpp.
template <class T, int Dim, int S>
AdjointKernels<T, Dim> adjoint_kernels(const deck::Method& method);

}  // namespace jaxmpm
