#pragma once
// The explicit stepper on the host (Du & He 2025, Eqs 9–18), one instance per precision and dimension.
#include "kernels/g2p.hpp"
#include "solvers/grid_update.hpp"
#include "solvers/particle_state.hpp"
#include "solvers/resting_blocks.hpp"
#include "solvers/support_arenas.hpp"

namespace jaxmpm {

template <class T, int Dim>
class ExplicitStep : public Solver {
 public:
  explicit ExplicitStep(const Model& model);

  void step(double dt) override;
  double stable_step() const override;

  std::uint64_t particle_count() const override;
  void take_snapshot(const FieldSelection& fields, bool ordered, std::vector<BodySnapshot>& bodies) const override;
  std::vector<BodySnapshot> snapshot_within(const std::vector<Region>& regions, const FieldSelection& fields) const override;
  void record_forces(bool on) override;
  ContactForces forces() const override;
  Dissipation dissipation() const override { return numbers_.dissipation; }
  std::vector<RawArray> save() const override;
  void restore(const std::vector<RawArray>& arrays) override;
  double bytes_per_particle() const override;
  PhaseSeconds phase_seconds() const override { return seconds_; }
  std::size_t active_blocks() const override { return blocks_.count(); }
  std::uint64_t sorts() const override { return sorts_; }
  std::uint64_t particles_at_rest() const override { return rest_.particles(); }

 protected:
  /// Particles may move this far, in cells, before they are sorted again: a tile's arena reaches one cell beyond its block.
  static constexpr double sort_after = 0.9;

  bool sort_is_due() const { return numbers_.drift > sort_after; }
  /// `orders` (may be null) receives per body where each particle was before.
  void sort(std::vector<std::vector<std::uint32_t>>* orders = nullptr);
  void wrap(Particles<T, Dim>& particles) const;
  void rebuild_blocks();
  /// Who rests, and what is left to do.
  void choose_work();
  void stop(const Tile& tile);
  void p2g();
  void scatter(std::size_t t, const StepConstants<T>& constants, T* arena) const;
  void update_grid(double dt);
  void g2p();
  void collect(double dt);
  bool all_have_left();
  Index<Dim> arena_origin(const Tile& tile) const;
  [[noreturn]] void report_failure() const;

  Model model_;
  StepKernels<T, Dim> kernels_;
  MaterialKernels<T, Dim> materials_;
  std::vector<Particles<T, Dim>> bodies_;
  Index<Dim> extent_;
  DomainBounds<Dim> domain_;

  Blocks<Dim> blocks_;
  std::vector<std::int64_t> tile_key_;
  SortScratch<T> scratch_;
  Array<T> arenas_;
  GridUpdate<T, Dim> grid_;
  StepConstants<T> constants_;
  std::vector<TileReport> reports_;
  RestingBlocks<Dim> rest_;
  SupportArenas<T, Dim> supports_;

  StepNumbers numbers_;
  std::uint64_t sorts_ = 0;  // by this object
  bool record_forces_ = false;
  PhaseSeconds seconds_;
};

}  // namespace jaxmpm
