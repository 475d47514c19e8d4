#pragma once
// Definitions of DeviceGrid and PhaseTimer.

#include "solvers/device_step.hpp"

namespace jaxmpm {

template <class T, int Dim, class Space>
DeviceGrid<T, Dim, Space>::DeviceGrid(const Model& model, const DeviceScheme<T, Dim, Space>& scheme)
    : model_(model), scheme_(scheme), contact_blocks_(model), mass_cut_off_(T(mass_cut_off(model))) {
  const WallTable<T, Dim>& walls = contact_blocks_.table();
  mirror(wall_ends_, "jaxmpm::walls", walls.to), mirror(wall_coefficients_, "jaxmpm::walls", walls.coefficient);
  tables_.walls = walls.view(wall_ends_.data(), wall_coefficients_.data());
  std::vector<ObstacleLaw<T>> laws;
  for (const RigidObstacle& obstacle : model.obstacles) laws.push_back({obstacle.kind, T(obstacle.coefficient)});
  mirror(obstacle_laws_, "jaxmpm::obstacles", laws);
  tables_.obstacle_laws = obstacle_laws_.data();
  tables_.contact_size = 3 * (GridTables<T, Dim>::faces + laws.size());
  contact_total_ = device_array<double, Space>("jaxmpm::contact", tables_.contact_size);
}

template <class T, int Dim, class Space>
void DeviceGrid<T, Dim, Space>::rebuild(const Blocks<Dim>& blocks) {
  contact_blocks_.rebuild(blocks);
  mirror(tiles_, "jaxmpm::tiles", blocks.tiles), mirror(index_, "jaxmpm::blocks", blocks.index);
  mirror(neighbour_, "jaxmpm::blocks", blocks.neighbour), mirror(wall_slot_, "jaxmpm::blocks", contact_blocks_.wall_slot());
  mirror_arenas(blocks);
  mirror(wall_block_, "jaxmpm::blocks", contact_blocks_.wall_blocks());
  mirror_obstacles(blocks.count());
  tables_.blocks = blocks.count(), tables_.wall_blocks = contact_blocks_.wall_blocks().size();
  grow<T>(arenas_, "jaxmpm::arenas", blocks.tiles.size() * scheme_.arena_size);
  grow<T>(raw_, "jaxmpm::grid", tables_.wall_blocks * scheme_.own_size), grow<T>(grid_, "jaxmpm::grid", tables_.blocks * scheme_.own_size);
  tables_.index = index_.data(), tables_.neighbour = neighbour_.data(), tables_.wall_slot = wall_slot_.data();
  tables_.first_arena = first_arena_.data(), tables_.arena_tile = arena_tile_.data();
  tables_.wall_block = wall_block_.data();
  tables_.first_obstacle_node = first_obstacle_node_.data(), tables_.obstacle_nodes = obstacle_nodes_.data();
  tables_.arenas = arenas_.data(), tables_.raw = raw_.data(), tables_.grid = grid_.data();
  grow<double>(friction_, "jaxmpm::contact", tables_.blocks);
  Kokkos::deep_copy(friction_, 0.0);
}

template <class T, int Dim, class Space>
void DeviceGrid<T, Dim, Space>::mirror_arenas(const Blocks<Dim>& blocks) {
  std::vector<std::uint32_t> first, tile;
  first.reserve(blocks.neighbour.size() + 1), tile.reserve(blocks.contributions.size());
  const std::uint32_t around = std::uint32_t(blocks.neighbour.size() / blocks.count());
  for (std::size_t b = 0; b < blocks.count(); ++b)
    for (std::uint32_t m = 0, k = blocks.first_contribution[b]; m < around; ++m) {
      first.push_back(std::uint32_t(tile.size()));
      for (; k < blocks.first_contribution[b + 1] && blocks.contributions[k].neighbour == m; ++k)
        tile.push_back(blocks.contributions[k].tile);
    }
  first.push_back(std::uint32_t(tile.size()));
  mirror(first_arena_, "jaxmpm::blocks", first), mirror(arena_tile_, "jaxmpm::blocks", tile);
}

template <class T, int Dim, class Space>
void DeviceGrid<T, Dim, Space>::mirror_obstacles(std::size_t blocks) {
  std::vector<std::uint32_t> first(1, 0);
  std::vector<ObstacleNode<T, Dim>> nodes;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (const auto* found = contact_blocks_.obstacles(b)) nodes.insert(nodes.end(), found->begin(), found->end());
    first.push_back(std::uint32_t(nodes.size()));
  }
  mirror(first_obstacle_node_, "jaxmpm::obstacles", first), mirror(obstacle_nodes_, "jaxmpm::obstacles", nodes);
}

template <class T, int Dim, class Space>
void DeviceGrid<T, Dim, Space>::update(const Space& space, double dt) {
  if (keep_sums_) grow<T>(sums_, "jaxmpm::grid", tables_.blocks * scheme_.own_size);
  tables_.sums = keep_sums_ ? sums_.data() : nullptr;
  if (forces_) {
    grow<double>(contact_, "jaxmpm::contact", tables_.blocks * tables_.contact_size);
    Kokkos::deep_copy(space, contact_, 0.0);
  }
  tables_.contact = forces_ ? contact_.data() : nullptr;
  tables_.friction = model_.account_energy ? friction_.data() : nullptr;
  scheme_.grid(space, tables_, constants(dt));
}

template <class T, int Dim, class Space>
std::vector<double> DeviceGrid<T, Dim, Space>::sum(const Space& space, const DeviceArray<double, Space>& table, std::size_t columns) const {
  parallel_for_teams<128, 0>("jaxmpm::contact", space, columns, 0,
                             SumColumns<Space>{table.data(), tables_.blocks, columns, contact_total_.data()});
  space.fence();
  std::vector<double> total(columns);
  copy_out(total.data(), contact_total_, 0, columns);
  return total;
}

template <class T, int Dim, class Space>
std::vector<double> DeviceGrid<T, Dim, Space>::contact(const Space& space) const {
  return sum(space, contact_, tables_.contact_size);
}

template <class T, int Dim, class Space>
double DeviceGrid<T, Dim, Space>::friction(const Space& space) const {
  return model_.account_energy && tables_.blocks > 0 ? sum(space, friction_, 1).front() : 0.0;
}

inline void PhaseTimer::begin_step() {
  ++steps_;
  step_.restart(), phase_.restart();
}

inline void PhaseTimer::end_phase(double PhaseSeconds::*phase) {
  sampled_.*phase += phase_.seconds();
  phase_.restart();
}

inline void PhaseTimer::end_step() { total_ += step_.seconds(); }

inline PhaseSeconds PhaseTimer::seconds(double sort) const {
  const double sampled = sampled_.p2g + sampled_.grid + sampled_.g2p, scale = sampled > 0 ? total_ / sampled : 0;
  return {sort, sampled_.p2g * scale, sampled_.grid * scale, sampled_.g2p * scale};
}

}  // namespace jaxmpm
