#pragma once
// The adjoint kernels of one scheme and one body on a device, beside kernels/device/scheme.hpp.
#include "kernels/device/adjoint/grid.hpp"
#include "kernels/device/adjoint/snapshot.hpp"
#include "kernels/device/scheme.hpp"

namespace jaxmpm {

/// The particles of one body, and derivatives by their fields and by what they gathered.
template <class T, int Dim>
struct BodyBars {
  ParticleFields<T, Dim> particles, bars;
  T* gathered;            // GatheredBarTable
  double* flip_fraction;  // places of ConstantBars
  double* body;
};

template <class T, int Dim, class Space>
class BodyAdjointKernels {
 public:
  virtual ~BodyAdjointKernels() = default;
  /// Adjoint of g2p: afterwards the tiles' arenas hold derivatives by the nodes that they saw. `grid`: velocities of all blocks.
  virtual void g2p(const Space&, std::size_t tiles, const BodyBars<T, Dim>&, const TileTable<T, Dim>&, const StepConstants<T>&,
                   const int* neighbour, const T* grid, const Index<Dim>& cells) const = 0;
  /// Adjoint of p2g. `by_sums`: derivatives by the sums of all blocks.
  virtual void p2g(const Space&, std::size_t tiles, const BodyBars<T, Dim>&, const TileTable<T, Dim>&, const StepConstants<T>&,
                   const int* neighbour, const T* by_sums) const = 0;
  virtual void add_snapshot(const Space&, std::size_t count, const BodyBars<T, Dim>&, const SnapshotBars&, std::uint32_t first_id,
                            double cell_size) const = 0;
};

template <class T, int Dim, class Space>
struct DeviceAdjoint {
  std::size_t gathered_rows = 0;  // of GatheredBarTable
  void (*grid)(const Space&, const GridTables<T, Dim>&, const GridConstants<T, Dim>&, const GridBarTables<T>&) = nullptr;
  std::unique_ptr<BodyAdjointKernels<T, Dim, Space>> (*body)(const deck::Material&) = nullptr;
};

/// The adjoint kernels of a method. Defined per precision, dimension and spline in kernels/device/adjoint/cuda_*.cu.
template <class T, int Dim, int S, class Space>
DeviceAdjoint<T, Dim, Space> device_adjoint(deck::Transfer transfer, deck::GradientForm gradient);

}  // namespace jaxmpm
