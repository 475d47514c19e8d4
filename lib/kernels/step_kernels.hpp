#pragma once
// The kernels of one scheme behind plain function pointers: the stepper is compiled once per precision and dimension, the schemes in
// translation units of their own.
#include "kernels/grid.hpp"
#include "kernels/material_kernel.hpp"
#include "kernels/p2g.hpp"
#include "state/sort.hpp"

namespace jaxmpm {

template <class T, int Dim>
struct StepKernels {
  double base_shift = 0;  // of Bspline, cells
  int planes = 0;
  std::size_t arena_size = 0, own_size = 0;  // values per tile and per block

  Index<Dim> (*block_extent)(const std::array<int, 3>& cells) = nullptr;
  void (*sort)(Particles<T, Dim>&, std::uint32_t body, const Index<Dim>& extent, SortScratch<T>&, std::vector<Tile>&,
               std::vector<std::int64_t>& key) = nullptr;
  void (*build_blocks)(Blocks<Dim>&, const std::vector<std::int64_t>& key, const Index<Dim>& extent) = nullptr;

  void (*p2g)(const ParticleView<T, Dim>&, std::size_t begin, std::size_t end, const MaterialKernel<T, Dim>&, const StepConstants<T>&,
              const Index<Dim>& origin, T* arena) = nullptr;
  void (*sum)(const Blocks<Dim>&, std::size_t block, const T* arenas, T* own) = nullptr;
  void (*update_nodes)(const T* sums, T* own, const GridConstants<T, Dim>&) = nullptr;
  TileReport (*g2p)(ParticleView<T, Dim>&, const Tile&, const Blocks<Dim>&, const T* grid, const MaterialKernel<T, Dim>&,
                    const StepConstants<T>&, bool account, const Index<Dim>& origin, const DomainBounds<Dim>&) = nullptr;
};

/// The kernels of a method. Defined per precision, dimension and spline in kernels/schemes_*.cpp.
template <class T, int Dim, int S>
StepKernels<T, Dim> step_kernels(const deck::Method& method);

}  // namespace jaxmpm
