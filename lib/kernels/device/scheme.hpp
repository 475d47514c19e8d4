#pragma once
// The device kernels of one scheme behind plain function pointers, and of one body behind an interface: as kernels/step_kernels.hpp on the
// host, the stepper is compiled once per precision and dimension.
#include <memory>

#include "kernels/device/g2p.hpp"
#include "kernels/device/grid.hpp"
#include "state/sort.hpp"

namespace jaxmpm {

/// What the gather needs besides the particles.
template <class T, int Dim>
struct GatherTables {
  const int* neighbour;
  const T* grid;
  Index<Dim> cells;
  bool account;
  double* report;
};

/// The transfers of one body, with its law inside the kernels.
template <class T, int Dim, class Space>
class BodyKernels {
 public:
  virtual ~BodyKernels() = default;
  virtual void p2g(const Space&, std::size_t tiles, const ParticleFields<T, Dim>&, const TileTable<T, Dim>&,
                   const StepConstants<T>&) const = 0;
  virtual void g2p(const Space&, std::size_t tiles, const ParticleFields<T, Dim>&, const TileTable<T, Dim>&, const StepConstants<T>&,
                   const GatherTables<T, Dim>&) const = 0;
};

template <class T, int Dim, class Space>
struct DeviceScheme {
  int planes = 0;
  double base_shift = 0;
  std::size_t arena_size = 0, own_size = 0;  // values per tile and per block
  Index<Dim> (*block_extent)(const std::array<int, 3>& cells) = nullptr;
  void (*sort)(Particles<T, Dim>&, std::uint32_t body, const Index<Dim>& extent, SortScratch<T>&, std::vector<Tile>&,
               std::vector<std::int64_t>& tile_key) = nullptr;  // of particles on the host
  void (*build_blocks)(Blocks<Dim>&, const std::vector<std::int64_t>& key, const Index<Dim>& extent) = nullptr;
  void (*grid)(const Space&, const GridTables<T, Dim>&, const GridConstants<T, Dim>&) = nullptr;
  std::unique_ptr<BodyKernels<T, Dim, Space>> (*body)(const deck::Material&) = nullptr;
};

/// The kernels of a method. Defined per precision, dimension and spline in kernels/device/cuda_*.cu.
template <class T, int Dim, int S, class Space>
DeviceScheme<T, Dim, Space> device_scheme(deck::Transfer transfer, deck::GradientForm gradient);

}  // namespace jaxmpm
