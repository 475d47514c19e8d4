#pragma once
#include "kernels/device/p2g.hpp"
#include "kernels/device/scheme.hpp"
#include "materials/registry.hpp"
#include "state/sort.hpp"

namespace jaxmpm {

template <class Sch, class Law, class Space>
class LawBodyKernels final : public BodyKernels<typename Sch::T, Sch::Dim, Space> {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  Law law_;

 public:
  explicit LawBodyKernels(const Law& law) : law_(law) {}

  void p2g(const Space& space, std::size_t tiles, const ParticleFields<T, Dim>& particles, const TileTable<T, Dim>& table,
           const StepConstants<T>& step) const override {
    using Gift = StepGift<Sch, Law>;
    using Kernel = ScatterTiles<Sch, Gift, Space>;
    parallel_for_teams<Kernel::threads, Kernel::resident>("jaxmpm::p2g", space, tiles, Kernel::scratch,
                                                          Kernel{particles, table, Gift(law_, step)});
  }
  void g2p(const Space& space, std::size_t tiles, const ParticleFields<T, Dim>& particles, const TileTable<T, Dim>& table,
           const StepConstants<T>& step, const GatherTables<T, Dim>& from) const override {
    using Kernel = GatherTiles<Sch, Law, Space>;
    parallel_for_teams<Kernel::threads, Kernel::resident>(
        "jaxmpm::g2p", space, tiles, Kernel::scratch,
        Kernel{particles, table, law_, step, from.neighbour, from.grid, from.cells, from.account, from.report});
  }
};

namespace device_detail {

template <class Sch, class Space>
void update_grid(const Space& space, const GridTables<typename Sch::T, Sch::Dim>& table,
                 const GridConstants<typename Sch::T, Sch::Dim>& constants) {
  parallel_for_teams<grid_threads, grid_resident>("jaxmpm::grid", space, table.blocks, 0, SumNodes<Sch, Space>{table, constants});
  parallel_for_teams<grid_threads, grid_resident>("jaxmpm::walls", space, table.wall_blocks, 0,
                                                  WallNodes<typename Sch::T, Sch::Dim, Sch::planes, Space>{table, constants});
}

template <class Sch, class Space>
std::unique_ptr<BodyKernels<typename Sch::T, Sch::Dim, Space>> make_body(const deck::Material& material) {
  using Base = BodyKernels<typename Sch::T, Sch::Dim, Space>;
  return with_law<typename Sch::T>(material, [](const auto& law) -> std::unique_ptr<Base> {
    return std::make_unique<LawBodyKernels<Sch, std::decay_t<decltype(law)>, Space>>(law);
  });
}

/// The grid knows of the transfer only whether there is a change of velocity: two compilations of it for all schemes of a spline.
template <class Sch>
using GridOf = Scheme<typename Sch::T, Sch::Dim, Sch::S, Sch::flip ? deck::Transfer::flip : deck::Transfer::pic, false>;

template <class Sch, class Space>
DeviceScheme<typename Sch::T, Sch::Dim, Space> scheme_of() {
  constexpr int Dim = Sch::Dim, S = Sch::S;
  DeviceScheme<typename Sch::T, Dim, Space> s;
  s.planes = Sch::planes, s.base_shift = Bspline<S>::base_shift;
  s.arena_size = Sch::arena_size, s.own_size = Sch::own_size;
  s.block_extent = &block_extent<Dim, S>;
  s.sort = &sort_particles<S, typename Sch::T, Dim>;
  s.build_blocks = &build_blocks<S, Dim>;
  s.grid = &update_grid<GridOf<Sch>, Space>;
  s.body = &make_body<Sch, Space>;
  return s;
}

/// Calls f(scheme) with the scheme of a transfer.
template <class T, int Dim, int S, bool mls, class F>
auto with_transfer(deck::Transfer transfer, F&& f) {
  using deck::Transfer;
  switch (transfer) {
    case Transfer::flip:
      return f(Scheme<T, Dim, S, Transfer::flip, mls>{});
    case Transfer::apic:  // with linear splines APIC is TPIC
      if constexpr (S > 2) return f(Scheme<T, Dim, S, Transfer::apic, mls>{});
      [[fallthrough]];
#if defined(JAXMPM_CUDA_SUBSET)
    default:
      throw std::logic_error("only flip and apic are compiled in the CUDA subset");
#else
    case Transfer::tpic:
      return f(Scheme<T, Dim, S, Transfer::tpic, mls>{});
    case Transfer::pic:
      break;
#endif
  }
#if !defined(JAXMPM_CUDA_SUBSET)
  return f(Scheme<T, Dim, S, Transfer::pic, mls>{});
#endif
}

}  // namespace device_detail

/// Calls f(scheme) with the scheme of a method.
template <class T, int Dim, int S, class F>
auto with_device_scheme(deck::Transfer transfer, deck::GradientForm gradient, F&& f) {
  if constexpr (S > 2)
    if (gradient == deck::GradientForm::mls) return device_detail::with_transfer<T, Dim, S, true>(transfer, f);
  return device_detail::with_transfer<T, Dim, S, false>(transfer, f);
}

template <class T, int Dim, int S, class Space>
DeviceScheme<T, Dim, Space> device_scheme(deck::Transfer transfer, deck::GradientForm gradient) {
  return with_device_scheme<T, Dim, S>(transfer, gradient, [](auto scheme) { return device_detail::scheme_of<decltype(scheme), Space>(); });
}

}  // namespace jaxmpm
