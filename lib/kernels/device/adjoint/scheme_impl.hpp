#pragma once
#include "core/error.hpp"
#include "kernels/device/adjoint/g2p.hpp"
#include "kernels/device/adjoint/p2g.hpp"
#include "kernels/device/adjoint/scheme.hpp"
#include "kernels/device/scheme_impl.hpp"

namespace jaxmpm {

template <class Sch, class Law, class Space>
class LawAdjointKernels final : public BodyAdjointKernels<typename Sch::T, Sch::Dim, Space> {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  Law law_;

 public:
  explicit LawAdjointKernels(const Law& law) : law_(law) {}

  void g2p(const Space& space, std::size_t tiles, const BodyBars<T, Dim>& of, const TileTable<T, Dim>& table, const StepConstants<T>& step,
           const int* neighbour, const T* grid, const Index<Dim>& cells) const override {
    using Kernel = GatherAdjoint<Sch, Law, Space>;
    const GatheredBarTable<Sch> gathered{of.gathered, of.particles.stride};
    parallel_for_teams<Kernel::threads, Kernel::resident>(
        "jaxmpm::g2p_adjoint", space, tiles, Kernel::scratch,
        Kernel{of.particles, of.bars, table, law_, step, neighbour, grid, cells, gathered, of.flip_fraction, of.body});
    using Scatter = ScatterTiles<Sch, GatheredBarTable<Sch>, Space>;
    parallel_for_teams<Scatter::threads, Scatter::resident>("jaxmpm::g2p_adjoint_scatter", space, tiles, Scatter::scratch,
                                                            Scatter{of.particles, table, gathered});
  }
  void p2g(const Space& space, std::size_t tiles, const BodyBars<T, Dim>& of, const TileTable<T, Dim>& table, const StepConstants<T>& step,
           const int* neighbour, const T* by_sums) const override {
    using Kernel = ScatterAdjoint<Sch, Law, Space>;
    parallel_for_teams<Kernel::threads, Kernel::resident>("jaxmpm::p2g_adjoint", space, tiles, Kernel::scratch,
                                                          Kernel{of.particles, of.bars, table, law_, step, neighbour, by_sums, of.body});
  }
  void add_snapshot(const Space& space, std::size_t count, const BodyBars<T, Dim>& of, const SnapshotBars& by, std::uint32_t first_id,
                    double cell_size) const override {
    using Kernel = AddSnapshot<T, Dim, Law, Space>;
    parallel_for_teams<Kernel::threads, 0>("jaxmpm::add_snapshot", space, (count + Kernel::threads - 1) / Kernel::threads, 0,
                                           Kernel{of.particles, of.bars, by, count, first_id, cell_size, law_, of.body});
  }
};

namespace device_detail {

template <class Sch, class Space>
void grid_adjoint(const Space& space, const GridTables<typename Sch::T, Sch::Dim>& table,
                  const GridConstants<typename Sch::T, Sch::Dim>& constants, const GridBarTables<typename Sch::T>& to) {
  parallel_for_teams<grid_threads, 0>("jaxmpm::grid_adjoint", space, table.blocks, 0, NodesAdjoint<Sch, Space>{table, constants, to});
  parallel_for_teams<grid_threads, 0>("jaxmpm::walls_adjoint", space, table.wall_blocks, 0,
                                      WallNodesAdjoint<typename Sch::T, Sch::Dim, Sch::planes, Space>{table, constants, to});
}

template <class Sch, class Space>
std::unique_ptr<BodyAdjointKernels<typename Sch::T, Sch::Dim, Space>> make_adjoint_body(const deck::Material& material) {
  using Base = BodyAdjointKernels<typename Sch::T, Sch::Dim, Space>;
  return with_law<typename Sch::T>(material, [](const auto& law) -> std::unique_ptr<Base> {
    using Law = std::decay_t<decltype(law)>;
    if constexpr (Law::by_hand) return std::make_unique<LawAdjointKernels<Sch, Law, Space>>(law);
    else throw Error(ExitCode::deck, "a GPU has no tape to differentiate this material by; use --backend cpu");
  });
}

template <class Sch, class Space>
DeviceAdjoint<typename Sch::T, Sch::Dim, Space> adjoint_of() {
  return {std::size_t(GatheredBarTable<Sch>::rows), &grid_adjoint<GridOf<Sch>, Space>, &make_adjoint_body<Sch, Space>};
}

}  // namespace device_detail

template <class T, int Dim, int S, class Space>
DeviceAdjoint<T, Dim, Space> device_adjoint(deck::Transfer transfer, deck::GradientForm gradient) {
  return with_device_scheme<T, Dim, S>(transfer, gradient,
                                       [](auto scheme) { return device_detail::adjoint_of<decltype(scheme), Space>(); });
}

}  // namespace jaxmpm
