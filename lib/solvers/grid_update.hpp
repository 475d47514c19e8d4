#pragma once
// The grid update of a step (Eqs 13–15): which blocks touch walls and obstacles, and what those do to the nodes of a block.
#include <memory>
#include <unordered_map>

#include "kernels/step_kernels.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// What contact did in one block during one step: impulses on the material, N s, and friction, J.
struct BlockContact {
  std::array<Point, 6> face{};
  std::vector<Point> obstacle;
  double friction = 0;
};

template <class T, int Dim>
class GridUpdate {
 public:
  GridUpdate(const Model& model, const StepKernels<T, Dim>& kernels);

  /// Learns the blocks of a new sort: which lie at walls, which nodes are inside obstacles.
  void rebuild(const Blocks<Dim>& blocks);
  /// Sums the arenas and turns them into velocities: afterwards grid() holds {–, v} (and FLIP's {–, Δv}) of every active block.
  void update(const Blocks<Dim>& blocks, const T* arenas, double dt);
  const T* grid() const { return grid_.data(); }

  void record_contact(bool on) { recording_ = on; }
  /// Totals of the last update, added up in the order of blocks.
  BlockContact contact() const;
  std::size_t bytes() const { return (grid_.capacity() + raw_.capacity()) * sizeof(T); }

 private:
  using Node = Index<Dim>;
  static constexpr int B = BlockShape<Dim, 2>::B, cells = BlockShape<Dim, 2>::cells, around = BlockShape<Dim, 2>::neighbours;
  using ObstacleNodes = std::vector<ObstacleNode<T, Dim>>;

  void update_block(const Blocks<Dim>& blocks, std::size_t b, const T* arenas, const GridConstants<T, Dim>& constants);
  void update_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants);
  void apply_obstacles(std::size_t b);
  std::shared_ptr<const ObstacleNodes> obstacle_nodes(const Node& block);
  bool at_wall(const Node& block) const;

  const Model& model_;
  StepKernels<T, Dim> kernels_;
  Walls<T, Dim> walls_;
  T mass_cut_off_;
  Array<T> grid_, raw_;         // [block][own], [wall block][own]
  std::vector<int> wall_slot_;  // [block] place in raw_, −1 away from walls
  std::vector<std::uint32_t> wall_blocks_;
  std::vector<std::shared_ptr<const ObstacleNodes>> obstacles_;                   // [block], null where there are none
  std::unordered_map<std::int64_t, std::shared_ptr<const ObstacleNodes>> known_;  // by block coordinates: obstacles stand still
  bool recording_ = false;
  std::vector<BlockContact> contact_;  // [block]
};

}  // namespace jaxmpm
