#include "solvers/grid_update.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "core/error.hpp"
#include "core/parallel_host.hpp"
#include "fields/body_force.hpp"

namespace jaxmpm {
namespace {

template <class T, int Dim>
void add(Point& to, const T& impulse) {
  for (int c = 0; c < Dim; ++c) to[std::size_t(c)] += double(impulse[std::size_t(c)]);
}

}  // namespace

template <class T, int Dim>
GridUpdate<T, Dim>::GridUpdate(const Model& model, const StepKernels<T, Dim>& kernels)
    : model_(model),
      kernels_(kernels),
      contact_blocks_(model),
      walls_(contact_blocks_.table().view()),
      mass_cut_off_(T(mass_cut_off(model))),
      packed_(kernels_.planes) {
  static_assert(cells == PackedSums<T>::cells);
}

template <class T, int Dim>
void GridUpdate<T, Dim>::rebuild(const Blocks<Dim>& blocks) {
  contact_blocks_.rebuild(blocks);
  grid_.resize(blocks.count() * kernels_.own_size), raw_.resize(contact_blocks_.wall_blocks().size() * kernels_.own_size);
  if (model_.body_force) force_.resize(blocks.count() * std::size_t(cells * Dim));
  contact_.resize(blocks.count());
  summed_.resize(blocks.count()), at_walls_ = contact_blocks_.wall_blocks();
  std::iota(summed_.begin(), summed_.end(), 0u);
  near_awake_.assign(blocks.count(), 1);
}

template <class T, int Dim>
void GridUpdate<T, Dim>::select(const Blocks<Dim>& blocks, const std::vector<char>& awake, bool forces) {
  const auto mark_around = [&](std::size_t b, std::vector<char>& mark, const auto& which) {
    for (std::size_t m = 0; m < around; ++m) {
      const int other = blocks.neighbour[b * around + m];
      if (other >= 0 && which(std::size_t(other))) mark[std::size_t(other)] = 1;
    }
  };
  near_awake_.assign(blocks.count(), 0);
  for (std::size_t b = 0; b < blocks.count(); ++b)
    if (awake[b]) mark_around(b, near_awake_, [](std::size_t) { return true; });
  std::vector<char> summed = near_awake_;
  if (forces)
    for (std::size_t b = 0; b < blocks.count(); ++b) summed[b] = summed[b] || touches(b);
  at_walls_.clear();
  for (const std::uint32_t b : contact_blocks_.wall_blocks())
    if (summed[b]) at_walls_.push_back(b);
  for (const std::uint32_t b : at_walls_)  // where its images are
    mark_around(b, summed, [&](std::size_t other) { return contact_blocks_.wall_slot()[other] >= 0; });
  summed_.clear();
  for (std::size_t b = 0; b < blocks.count(); ++b)
    if (summed[b]) summed_.push_back(std::uint32_t(b));
}

template <class T, int Dim>
WallSums<T, Dim> GridUpdate<T, Dim>::wall_sums(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) const {
  return {blocks.neighbour.data() + b * around,
          contact_blocks_.wall_slot().data(),
          raw_.data(),
          kernels_.planes,
          first_node<Dim>(blocks.index[b]),
          constants,
          force()};
}

/// Where the sums of a block are put: those of wall blocks, which neighbours ask for, and those to be kept beside the velocities.
template <class T, int Dim>
T* GridUpdate<T, Dim>::place_of_sums(std::size_t b) {
  const std::size_t size = kernels_.own_size;
  const int wall_slot = contact_blocks_.wall_slot()[b];
  if (wall_slot >= 0) return raw_.data() + std::size_t(wall_slot) * size;
  return (keep_sums_ ? sums_ : grid_).data() + b * size;
}

template <class T, int Dim>
void GridUpdate<T, Dim>::update(const Blocks<Dim>& blocks, const T* arenas, double dt, double time) {
  if (keep_sums_) sums_.resize(blocks.count() * kernels_.own_size), packed_.begin(blocks.count());
  const auto sums_of = [&](std::size_t b) {
    T* to = place_of_sums(b);
    kernels_.sum(blocks, b, arenas, to);
    if (keep_sums_) packed_.look_at(b, to);
    return to;
  };
  update_from(blocks, sums_of, dt, time);
}

template <class T, int Dim>
void GridUpdate<T, Dim>::update_again(const Blocks<Dim>& blocks, const std::byte* packed, double dt, double time) {
  sums_.resize(blocks.count() * kernels_.own_size);
  packed_.open(blocks.count(), packed);
  const auto sums_of = [&](std::size_t b) {
    T* to = place_of_sums(b);
    packed_.unpack(b, to);
    return to;
  };
  update_from(blocks, sums_of, dt, time);
}

/// `sums_of(b)` gives the sums of a block's own nodes, and sees to it that those of wall blocks are where neighbours look for them.
template <class T, int Dim>
template <class Sums>
void GridUpdate<T, Dim>::update_from(const Blocks<Dim>& blocks, const Sums& sums_of, double dt, double time) {
  const GridConstants<T, Dim> constants = this->constants(dt);
  parallel_for_host("jaxmpm::grid", summed_.size(), [&](std::size_t k) {
    const std::size_t b = summed_[k];
    if (recording_) contact_[b] = {}, contact_[b].obstacle.resize(model_.obstacles.size());
    kernels_.update_nodes(sums_of(b), grid_.data() + b * kernels_.own_size, constants);
    if (model_.body_force) apply_body_force(blocks, b, constants, dt, time);
    if (contact_blocks_.obstacles(b)) apply_obstacles(blocks, b);
  });
  if (model_.body_force) refuse_bad_force(blocks, time);
  parallel_for_host("jaxmpm::walls", at_walls_.size(), [&](std::size_t w) { update_wall_block(blocks, at_walls_[w], constants); });
}

/// Adds Δt b of a block's nodes to their velocities, and keeps it for those near walls.
template <class T, int Dim>
void GridUpdate<T, Dim>::apply_body_force(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants, double dt,
                                          double time) {
  T *own = grid_.data() + b * kernels_.own_size, *force = force_.data() + b * std::size_t(cells * Dim);
  const Node first = first_node<Dim>(blocks.index[b]);
  const BodyForce::Loan field(*model_.body_force);
  for (int n = 0; n < cells; ++n) {
    const bool some = own[4 * n] > constants.mass_cut_off;
    const Point b_i = some ? field.at(place(node_of<Dim>(first, n)), time) : Point{};
    if (!std::isfinite(b_i[0] + b_i[1] + b_i[2])) note_bad_force(b * std::size_t(cells) + std::size_t(n));
    for (int c = 0; c < Dim; ++c) {
      const T step = T(dt * b_i[std::size_t(c)]), kept = step - constants.damped * step;
      force[n * Dim + c] = step;
      own[4 * n + 1 + c] += kept;
      if (kernels_.planes == 2) own[4 * (cells + n) + 1 + c] += kept;
    }
  }
}

/// Keeps the first of the nodes where the body force is no number.
template <class T, int Dim>
void GridUpdate<T, Dim>::note_bad_force(std::size_t node) {
  std::size_t known = bad_force_.load();
  while (node < known && !bad_force_.compare_exchange_weak(known, node)) continue;
}

template <class T, int Dim>
void GridUpdate<T, Dim>::refuse_bad_force(const Blocks<Dim>& blocks, double time) {
  const std::size_t node = bad_force_.exchange(none);
  if (node == none) return;
  const Point x = place(node_of<Dim>(first_node<Dim>(blocks.index[node / std::size_t(cells)]), int(node % std::size_t(cells))));
  std::string where = fmt::format("({:.6g}, {:.6g}", x[0], x[1]);
  if (Dim == 3) where += fmt::format(", {:.6g}", x[2]);
  throw NumericsError(fmt::format("/body_force is not a finite number at the node {}) at {:.6g} s, where there is material", where, time));
}

template <class T, int Dim>
void GridUpdate<T, Dim>::record(std::size_t b, std::uint32_t obstacle, const ObstacleContact<T, Dim>& done) {
  add<Vector<T, Dim>, Dim>(contact_[b].obstacle[obstacle], done.impulse);
  contact_[b].friction += double(done.friction_work);
}

template <class T, int Dim>
void GridUpdate<T, Dim>::apply_obstacles(const Blocks<Dim>& blocks, std::size_t b) {
  T* own = grid_.data() + b * kernels_.own_size;
  const Node first = first_node<Dim>(blocks.index[b]);
  const bool at_wall = contact_blocks_.wall_slot()[b] >= 0;
  for (const ObstacleNode<T, Dim>& node : *contact_blocks_.obstacles(b)) {
    if (at_wall && walls_.near_face(node_of<Dim>(first, int(node.node)))) continue;  // the walls come first there
    const RigidObstacle& obstacle = model_.obstacles[node.obstacle];
    T* quad = own + 4 * node.node;
    const auto done = push_node<T, Dim>(obstacle.kind, T(obstacle.coefficient), node.normal, mass_cut_off_, quad,
                                        kernels_.planes == 2 ? quad + cells * 4 : nullptr);
    if (recording_) record(b, node.obstacle, done);
  }
}

/// The nodes of a block that are on a face, or whose images are; the others have their velocities already.
template <class T, int Dim>
void GridUpdate<T, Dim>::update_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants) {
  const int* neighbours = blocks.neighbour.data() + b * around;
  const Node first = first_node<Dim>(blocks.index[b]);
  const WallSums<T, Dim> raw = wall_sums(blocks, b, constants);
  bool inside = false;
  const auto obstacles = [&](const Node& node, T mass, Vector<T, Dim>& v) {
    const Place<Dim> at = locate<Dim>(neighbours, first, node);
    if (at.block < 0 || !contact_blocks_.obstacles(std::size_t(at.block))) return;
    for (const ObstacleNode<T, Dim>& o : *contact_blocks_.obstacles(std::size_t(at.block))) {
      if (int(o.node) != at.own) continue;
      const RigidObstacle& obstacle = model_.obstacles[o.obstacle];
      const auto done = apply_obstacle<T, Dim>(obstacle.kind, T(obstacle.coefficient), o.normal, mass, v);
      if (recording_ && inside) record(b, o.obstacle, done);
    }
  };
  const WallUpdate<T, Dim, decltype(raw), decltype(obstacles)> walls(walls_, raw, obstacles, mass_cut_off_);
  T* out = grid_.data() + b * kernels_.own_size;
  for (int own = 0; own < cells; ++own) {
    const Node node = node_of<Dim>(first, own);
    if (!walls_.near_face(node) || !(raw.quad(int(b), own)[0] > 0)) continue;
    const NodeStanding at = standing<T, Dim>(walls_, node);
    inside = at.inside;
    NodeContact<T, Dim> contact;
    Vector<T, Dim> v{};
    if (at.reached) v = walls.velocity(node, recording_ ? &contact : nullptr);
    write_wall_node(raw.quad(int(b), own), v, mass_cut_off_, kernels_.planes, own, out);
    if (!recording_) continue;
    for (std::size_t f = 0; f < 2 * Dim; ++f) add<decltype(contact.impulse[f]), Dim>(contact_[b].face[f], contact.impulse[f]);
    contact_[b].friction += double(contact.friction_work);
  }
}

template <class T, int Dim>
BlockContact GridUpdate<T, Dim>::contact() const {
  BlockContact total;
  total.obstacle.resize(model_.obstacles.size());
  for (const std::uint32_t b : summed_) {
    const BlockContact& block = contact_[b];
    for (std::size_t f = 0; f < 6; ++f) add<Point, 3>(total.face[f], block.face[f]);
    for (std::size_t o = 0; o < block.obstacle.size(); ++o) add<Point, 3>(total.obstacle[o], block.obstacle[o]);
    if (near_awake_[b]) total.friction += block.friction;
  }
  return total;
}

template class GridUpdate<float, 2>;
template class GridUpdate<float, 3>;
template class GridUpdate<double, 2>;
template class GridUpdate<double, 3>;

}  // namespace jaxmpm
