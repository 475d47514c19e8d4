#pragma once
// The explicit stepper on a device (Du & He 2025, Eqs 9–18): the layout and the kernels' mathematics of ExplicitStep, with the particles
// and the grid in the device's memory. A step moves nothing to the host but its report. Runs on any Kokkos execution space.
#include "core/stopwatch.hpp"
#include "kernels/device/scheme.hpp"
#include "kernels/device/sort.hpp"
#include "solvers/contact_blocks.hpp"
#include "solvers/particle_state.hpp"

namespace jaxmpm {

/// Blocks, contact and arenas of a sort in a device's memory.
template <class T, int Dim, class Space>
class DeviceGrid {
 public:
  /// `model` has to outlive this object.
  DeviceGrid(const Model& model, const DeviceScheme<T, Dim, Space>& scheme);

  /// Learns the blocks of a new sort.
  void rebuild(const Blocks<Dim>& blocks);
  /// Sums the arenas and turns them into velocities, in the space's queue.
  void update(const Space& space, double dt);

  /// From now on tables().sums holds what the last update found at the nodes: the adjoint needs it.
  void keep_sums() { keep_sums_ = true; }
  GridConstants<T, Dim> constants(double dt) const { return grid_constants<T, Dim>(model_, mass_cut_off_, dt); }
  std::size_t segments() const { return contact_blocks_.table().coefficient.size(); }
  const GridTables<T, Dim>& tables() const { return tables_; }
  T* arenas() const { return arenas_.data(); }
  const Tile* tiles() const { return tiles_.data(); }

  void record_forces(bool on) { forces_ = on; }
  /// Impulse of each face and obstacle in the last update, three values each, N s.
  std::vector<double> contact(const Space& space) const;
  /// Work of friction since the last sort, J; zero unless the model accounts for energy.
  double friction(const Space& space) const;

 private:
  void mirror_obstacles(std::size_t blocks);
  void mirror_arenas(const Blocks<Dim>& blocks);
  std::vector<double> sum(const Space& space, const DeviceArray<double, Space>& table, std::size_t columns) const;

  const Model& model_;
  DeviceScheme<T, Dim, Space> scheme_;
  ContactBlocks<T, Dim> contact_blocks_;
  T mass_cut_off_;
  GridTables<T, Dim> tables_{};
  bool forces_ = false, keep_sums_ = false;

  DeviceArray<Tile, Space> tiles_;
  DeviceArray<Index<Dim>, Space> index_;
  DeviceArray<int, Space> neighbour_, wall_slot_;
  DeviceArray<std::uint32_t, Space> first_arena_, arena_tile_, wall_block_, first_obstacle_node_;
  DeviceArray<ObstacleNode<T, Dim>, Space> obstacle_nodes_;
  DeviceArray<ObstacleLaw<T>, Space> obstacle_laws_;
  DeviceArray<double, Space> wall_ends_, contact_, friction_, contact_total_;
  DeviceArray<T, Space> wall_coefficients_, arenas_, raw_, grid_, sums_;
};

/// Wall time of the phases. A device runs behind its queue, so a phase is only timed where the queue is drained after it: every 32nd step;
/// the other steps count as a whole and are shared out in the same proportion.
class PhaseTimer {
 public:
  void begin_step();
  bool sampling() const { return steps_ % 32 == 1; }
  /// To be called when a sampled phase has ended.
  void end_phase(double PhaseSeconds::*phase);
  void end_step();
  PhaseSeconds seconds(double sort) const;

 private:
  std::uint64_t steps_ = 0;
  Stopwatch step_, phase_;
  double total_ = 0;
  PhaseSeconds sampled_;
};

template <class T, int Dim, class Space>
class DeviceStep : public Solver {
 public:
  DeviceStep(const Model& model, const DeviceScheme<T, Dim, Space>& scheme);

  void step(double dt) override;
  double stable_step() const override;

  std::uint64_t particle_count() const override;
  void take_snapshot(const FieldSelection& fields, bool ordered, std::vector<BodySnapshot>& bodies) const override;
  std::vector<BodySnapshot> snapshot_within(const std::vector<Region>& regions, const FieldSelection& fields) const override;
  void record_forces(bool on) override;
  ContactForces forces() const override;
  Dissipation dissipation() const override { return numbers().dissipation; }
  std::vector<RawArray> save() const override;
  void restore(const std::vector<RawArray>& arrays) override;
  double bytes_per_particle() const override;
  PhaseSeconds phase_seconds() const override { return timer_.seconds(sort_seconds_); }
  std::size_t active_blocks() const override { return blocks_.count(); }
  std::uint64_t sorts() const override { return sorts_; }

 protected:
  /// Particles may move this far, in cells, before they are sorted again: nearly as far as the arenas' halo reaches, as sorting costs more
  /// than order here.
  static constexpr double sort_after = 0.9;

  struct DeviceBody {
    DeviceParticles<T, Dim, Space> particles;
    std::unique_ptr<BodyKernels<T, Dim, Space>> kernels;
    std::size_t first_tile = 0, tiles = 0;
  };

  bool sort_is_due() const { return numbers_.drift > sort_after; }
  void sort_if_due();
  void sort();
  bool sort_on_device(std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key);
  void sort_on_host(std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key);
  void rebuild();
  StepNumbers numbers() const;
  void p2g();
  void g2p();
  void collect(double dt);
  TileTable<T, Dim> tile_table(const DeviceBody& body) const;
  std::vector<Particles<T, Dim>> bodies_on_host() const;
  [[noreturn]] void report_failure() const;

  Model model_;
  DeviceScheme<T, Dim, Space> scheme_;
  Space space_;
  MaterialKernels<T, Dim> materials_;
  std::vector<DeviceBody> bodies_;
  Index<Dim> extent_, cells_;

  Blocks<Dim> blocks_;
  std::vector<std::int64_t> tile_key_;
  DeviceSort<T, Dim, Space> sort_;
  DeviceGrid<T, Dim, Space> grid_;
  StepConstants<T> constants_;
  DeviceArray<double, Space> report_;     // StepReport of the step under way
  PinnedArray<double, Space> published_;  // and of the last one, where the host sees it

  StepNumbers numbers_;
  bool record_forces_ = false, contact_known_ = false;  // contact_known_: that of the last step is in grid_
  double sort_seconds_ = 0;
  std::uint64_t sorts_ = 0;
  PhaseTimer timer_;
};

}  // namespace jaxmpm
