#pragma once
// Which active blocks touch walls, and which of their nodes lie inside obstacles: learnt on the host at each sort, for any backend.
#include <memory>
#include <unordered_map>

#include "contact/obstacles.hpp"
#include "contact/walls.hpp"
#include "scene/model.hpp"
#include "state/blocks.hpp"

namespace jaxmpm {

template <class T, int Dim>
class ContactBlocks {
 public:
  using ObstacleNodes = std::vector<ObstacleNode<T, Dim>>;
  /// `model` has to outlive this object.
  explicit ContactBlocks(const Model& model) : model_(model), table_(model) {}

  /// Learns the blocks of a new sort.
  void rebuild(const Blocks<Dim>& blocks);
  const WallTable<T, Dim>& table() const { return table_; }
  /// [block] place among the wall blocks, −1 away from walls.
  const std::vector<int>& wall_slot() const { return wall_slot_; }
  const std::vector<std::uint32_t>& wall_blocks() const { return wall_blocks_; }
  /// Nodes of a block that are inside obstacles, in deck order of these, one entry for each surface that holds (holding_normals()); null
  /// where there are none.
  const ObstacleNodes* obstacles(std::size_t block) const { return obstacles_[block].get(); }

 private:
  using Node = Index<Dim>;
  std::shared_ptr<const ObstacleNodes> obstacle_nodes(const Node& block) const;
  bool at_wall(const Walls<T, Dim>& walls, const Node& block) const;

  const Model& model_;
  WallTable<T, Dim> table_;
  std::vector<int> wall_slot_;
  std::vector<std::uint32_t> wall_blocks_;
  std::vector<std::shared_ptr<const ObstacleNodes>> obstacles_;
  std::unordered_map<std::int64_t, std::shared_ptr<const ObstacleNodes>> known_;  // by block coordinates: obstacles stand still
};

/// What a node is to be heavier than to carry a velocity, kg (docs/theory.md, "Mass cut-off").
double mass_cut_off(const Model& model);

}  // namespace jaxmpm
