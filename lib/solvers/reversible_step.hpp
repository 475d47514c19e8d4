#pragma once
// The explicit stepper with its adjoint: step() is ExplicitStep's, step_adjoint() faces it in reversible_step.cpp.
#include "solvers/explicit_step.hpp"
#include "solvers/grid_adjoint.hpp"
#include "solvers/reversible.hpp"

namespace jaxmpm {

template <class T, int Dim>
class ReversibleStep final : public ExplicitStep<T, Dim>, public ReversibleSolver {
 public:
  explicit ReversibleStep(const Model& model);

  Solver& forward() override { return *this; }
  void expect_blocks(std::size_t most) override;
  std::size_t kept_bytes() const override { return particle_bytes(false) + room_for_sums_; }
  std::size_t lean_bytes() const override { return particle_bytes(adjoint_.between_steps) + room_for_sums_; }
  std::size_t shared_bytes() const override;
  std::size_t block_bytes() const override { return (this->kernels_.arena_size + 4 * this->kernels_.own_size) * sizeof(T); }
  bool may_be_lean() const override;
  std::unique_ptr<KeptState> keep(std::byte* numbers, bool lean) override;
  void keep_sums(KeptState& kept, std::byte* numbers) override;
  void go_back(const KeptState& kept, const std::byte* numbers) override;

  void start_reverse() override;
  void add_gradient(const SnapshotGradient& by) override;
  void step_adjoint(double dt, const KeptState& kept, const std::byte* numbers) override;
  void end_reverse() override;
  ModelGradient gradient() const override;
  std::uint64_t at_kinks() const override;

  /// Derivatives by the particles' fields, in storage order (position: per cell); `id` is empty. For tests, which may set them.
  std::vector<Particles<T, Dim>>& bars() {
    bars_move_ = true;
    return bars_;
  }
  const std::vector<Particles<T, Dim>>& particles() const { return this->bodies_; }

 private:
  using Orders = std::vector<std::vector<std::uint32_t>>;
  /// What stays the same from sort to sort.
  struct Epoch {
    std::vector<Array<std::uint32_t>> id;  // [body]
    std::vector<Tile> tiles;
    std::vector<std::int64_t> tile_key;
  };
  struct Kept final : KeptState {
    std::shared_ptr<const Epoch> epoch;
    StepNumbers numbers;
    bool has_sums = false;  // of the step from it, behind the numbers of its particles
    bool lean = false;
    std::uint64_t serial = 0;  // from 1
  };

  std::size_t particle_bytes(bool lean) const;
  std::shared_ptr<const Epoch> present_epoch();
  void update_grid_again(const Kept& kept, const std::byte* numbers, double dt);
  void g2p_adjoint();
  void update_grid_adjoint(double dt);
  void p2g_adjoint();
  void between_steps_adjoint(const StepConstants<T>& after, const std::byte* numbers);
  void read_present();  // the present state into bodies_, where that is still to be done
  void unsort(const Orders& orders);
  void add_report(std::size_t tile, const MaterialReport& report);
  void add_g2p_reports();
  void add_p2g_reports();
  void add_body_gradient(std::size_t b, const BodySnapshot& by);
  void add_stress_gradient(std::size_t b, const BodySnapshot& by);

  AdjointKernels<T, Dim> adjoint_;
  std::vector<std::unique_ptr<MaterialAdjoint<T, Dim>>> material_adjoints_;
  GridAdjoint<T, Dim> grid_adjoint_;
  std::size_t room_for_sums_ = 0;                  // bytes in a kept state
  std::vector<Array<T>> mass_;                     // [body][id less the first]
  std::shared_ptr<const Epoch> epoch_;             // of the present state, unless it has been sorted since:
  std::uint64_t epoch_sorts_ = ~std::uint64_t(0);  // sorts_ when it was
  std::vector<Particles<T, Dim>> bars_;            // derivatives by the particles' fields, in storage order
  bool bars_move_ = false;                         // those by motion may have been changed since the last step
  const std::byte* present_ = nullptr;             // numbers of the present state, where bodies_ has yet to be read from them
  bool present_is_lean_ = false;
  std::uint64_t waiting_ = 0;                     // serial of the present state where p2g_adjoint() of the step from it is still to be done
  std::uint64_t serials_ = 0;                     // of kept states so far
  std::uint64_t kept_sorts_ = ~std::uint64_t(0);  // sorts_ at the last keep()
  bool sums_kept_ = false;                        // those of the step since
  std::vector<AdjointReport> g2p_reports_;        // [tile]
  std::vector<MaterialReport> p2g_reports_;       // [tile]
  std::vector<MaterialReport> material_totals_;   // [body]
  double flip_fraction_ = 0;
};

}  // namespace jaxmpm
