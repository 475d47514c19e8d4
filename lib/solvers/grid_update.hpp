#pragma once
// The grid update of a step on the host (Eqs 13–15): sums of the arenas, and what walls and obstacles do to the nodes of a block.
#include <atomic>

#include "kernels/step_kernels.hpp"
#include "kernels/wall_node.hpp"
#include "solvers/contact_blocks.hpp"
#include "solvers/packed_sums.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// What contact did in one block, or in all, during one step: impulses on the material, N s, and friction, J.
struct BlockContact {
  std::array<Point, 6> face{};
  std::vector<Point> obstacle;
  double friction = 0;
};

template <class T, int Dim>
class GridUpdate {
 public:
  GridUpdate(const Model& model, const StepKernels<T, Dim>& kernels);

  /// Learns the blocks of a new sort: which lie at walls, which nodes are inside obstacles. All of them are updated.
  void rebuild(const Blocks<Dim>& blocks);
  /// From now on updates only the blocks around those that are `awake` ([block]) and, where contact `forces` are wanted, all that touch
  /// walls or obstacles.
  void select(const Blocks<Dim>& blocks, const std::vector<char>& awake, bool forces);
  /// The blocks whose arenas update() adds up, ascending.
  const std::vector<std::uint32_t>& summed() const { return summed_; }
  /// Sums the arenas and turns them into velocities: afterwards grid() holds {–, v} (and a second plane's {–, Δv}) of every block that is
  /// updated. `time`: that of the step's beginning, s.
  void update(const Blocks<Dim>& blocks, const T* arenas, double dt, double time);
  /// The same from sums that pack_sums() gave, to the same bits; they are kept.
  void update_again(const Blocks<Dim>& blocks, const std::byte* packed, double dt, double time);
  const T* grid() const { return grid_.data(); }

  void record_contact(bool on) { recording_ = on; }
  /// From now on sums() holds what the last update found at the nodes: the adjoint needs it.
  void keep_sums() { keep_sums_ = true; }
  /// Sums {m, p} (and a second plane's {–, impulse}) of a block's own nodes before the update.
  const T* sums(std::size_t b) const {
    const int slot = contact_blocks_.wall_slot()[b];
    return slot >= 0 ? raw_.data() + std::size_t(slot) * kernels_.own_size : sums_.data() + b * kernels_.own_size;
  }
  /// The kept sums of all blocks without what is zero, and the bytes that those of so many blocks take at most.
  void pack_sums(std::byte* to) {
    packed_.pack([&](std::size_t b) { return sums(b); }, to);
  }
  std::size_t packed_bytes(std::size_t blocks) const { return packed_.most_bytes(blocks); }
  /// Those of a block at walls and its neighbours, with Δt g.
  WallSums<T, Dim> wall_sums(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) const;
  GridConstants<T, Dim> constants(double dt) const { return grid_constants<T, Dim>(model_, mass_cut_off_, dt); }
  /// Δt (g + b) at a node of a block in the last update, m/s.
  Vector<T, Dim> pull(const GridConstants<T, Dim>& constants, std::size_t b, int own) const {
    return pull_at<T, Dim>(constants, force(), int(b), own);
  }
  /// Where a node lies, m, in the deck's coordinates.
  Point place(const Index<Dim>& node) const {
    Point x{};
    for (std::size_t d = 0; d < Dim; ++d) x[d] = model_.domain_min[d] + model_.cell_size * node[d];
    return x;
  }
  const ContactBlocks<T, Dim>& contact_blocks() const { return contact_blocks_; }
  const Walls<T, Dim>& walls() const { return walls_; }
  /// Totals of the last update, added up in the order of blocks; nothing rubs where all is at rest.
  BlockContact contact() const;
  std::size_t bytes() const { return (grid_.capacity() + raw_.capacity()) * sizeof(T); }

 private:
  using Node = Index<Dim>;
  static constexpr int cells = BlockShape<Dim, 2>::cells, around = BlockShape<Dim, 2>::neighbours;

  const T* force() const { return model_.body_force ? force_.data() : nullptr; }
  template <class Sums>
  void update_from(const Blocks<Dim>& blocks, const Sums& sums_of, double dt, double time);
  T* place_of_sums(std::size_t b);
  void note_bad_force(std::size_t node);
  /// Throws NumericsError where a node was noted.
  void refuse_bad_force(const Blocks<Dim>& blocks, double time);
  void apply_body_force(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants, double dt, double time);
  void update_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants);
  void apply_obstacles(const Blocks<Dim>& blocks, std::size_t b);
  void record(std::size_t b, std::uint32_t obstacle, const ObstacleContact<T, Dim>& done);
  bool touches(std::size_t b) const { return contact_blocks_.wall_slot()[b] >= 0 || contact_blocks_.obstacles(b); }

  static constexpr std::size_t none = ~std::size_t(0);
  std::atomic<std::size_t> bad_force_{none};  // [block][node]
  const Model& model_;
  StepKernels<T, Dim> kernels_;
  ContactBlocks<T, Dim> contact_blocks_;
  Walls<T, Dim> walls_;
  T mass_cut_off_;
  Array<T> grid_, raw_, sums_;  // [block][own], [wall block][own], [block][own] where kept
  Array<T> force_;              // [block][own node][Dim]: Δt b, m/s, where there is a body force
  PackedSums<T> packed_;        // the masks of the last ones
  bool keep_sums_ = false;
  bool recording_ = false;
  std::vector<std::uint32_t> summed_, at_walls_;  // blocks whose arenas are added up, and those whose wall nodes are updated
  std::vector<char> near_awake_;                  // [block] it, or one around it, is awake
  std::vector<BlockContact> contact_;             // [block]
};

}  // namespace jaxmpm
