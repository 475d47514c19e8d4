#pragma once
// The device stepper with its adjoint: step() is DeviceStep's, step_adjoint() faces it as in reversible_step.cpp. Derivatives, kept states
// and what the steps in between need stay in the device's memory. Runs on any Kokkos execution space.
#include "kernels/device/adjoint/scheme.hpp"
#include "solvers/device_step.hpp"
#include "solvers/reversible.hpp"

namespace jaxmpm {

template <class T, int Dim, class Space>
class DeviceReversibleStep final : public DeviceStep<T, Dim, Space>, public ReversibleSolver {
 public:
  DeviceReversibleStep(const Model& model, const DeviceScheme<T, Dim, Space>& scheme, const DeviceAdjoint<T, Dim, Space>& adjoint);

  Solver& forward() override { return *this; }
  /// Sums at the nodes are not kept: a scatter costs a third of a step here, and its sums as much memory as the particles.
  void expect_blocks(std::size_t) override {}
  void keep_sums(KeptState&, std::byte*) override {}
  std::size_t kept_bytes() const override;
  std::size_t lean_bytes() const override { return kept_bytes(); }
  std::size_t shared_bytes() const override;
  std::size_t block_bytes() const override { return (this->scheme_.arena_size + 4 * this->scheme_.own_size) * sizeof(T); }
  bool may_be_lean() const override { return false; }
  std::unique_ptr<KeptState> keep(std::byte* numbers, bool lean) override;
  void go_back(const KeptState& kept, const std::byte* numbers) override;

  void start_reverse() override;
  void add_gradient(const SnapshotGradient& by) override;
  void step_adjoint(double dt, const KeptState& kept, const std::byte* numbers) override;
  void end_reverse() override {}
  ModelGradient gradient() const override;
  std::uint64_t at_kinks() const override;

 private:
  using Ids = DeviceArray<std::uint32_t, Space>;
  /// What stays the same from sort to sort.
  struct Epoch {
    std::vector<Ids> id;  // [body]
    std::vector<Tile> tiles;
    std::vector<std::int64_t> tile_key;
  };
  struct Kept final : KeptState {
    std::shared_ptr<const Epoch> epoch;
    StepNumbers numbers;
  };
  /// Derivatives by a body's particles, and what its kernels need besides.
  struct Bars {
    DeviceParticles<T, Dim, Space> fields;
    std::unique_ptr<BodyAdjointKernels<T, Dim, Space>> kernels;
    std::unique_ptr<MaterialAdjoint<T, Dim>> material;
    DeviceArray<T, Space> gathered;
    Ids place;  // [id less the first], before the sort of the step that is reversed
    std::uint32_t first_id;
  };

  std::shared_ptr<const Epoch> present_epoch();
  BodyBars<T, Dim> tables(std::size_t b) const;
  std::vector<double> constants() const;
  void note_places();
  void unsort();
  void g2p_adjoint();
  void grid_adjoint(double dt);
  void p2g_adjoint();

  DeviceAdjoint<T, Dim, Space> adjoint_;
  std::vector<Bars> bars_;  // [body]
  ConstantBars places_;
  DeviceArray<double, Space> constant_bars_;       // ConstantBars
  DeviceArray<T, Space> by_sums_, by_velocity_;    // GridBarTables
  std::shared_ptr<const Epoch> epoch_;             // of the present state, unless it has been sorted since:
  std::uint64_t epoch_sorts_ = ~std::uint64_t(0);  // sorts_ when it was
};

}  // namespace jaxmpm
