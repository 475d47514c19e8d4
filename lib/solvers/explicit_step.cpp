#include "solvers/explicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel_host.hpp"
#include "core/stopwatch.hpp"

namespace jaxmpm {
namespace {

/// What holds particles along an axis: an open face nothing, though what passes it is noticed, a periodic one nothing at all.
PlaceBounds place_bounds(const Model& model, int axis) {
  constexpr double far = std::numeric_limits<double>::infinity();
  PlaceBounds at{-far, far, -far, far};
  if (model.is_periodic(axis)) return at;
  const double last = model.cells[std::size_t(axis)];
  at.lowest = 0, at.highest = last;
  if (!model.is_open(axis, false)) at.lower = 0, at.lowest = -held_within;
  if (!model.is_open(axis, true)) at.upper = last, at.highest = last + held_within;
  return at;
}

}  // namespace

/// One explicit step, stress updated last (Du & He 2025, Eqs 9–18).
template <class T, int Dim>
void ExplicitStep<T, Dim>::step(double dt) {
  constants_.dt = T(dt);
  if (sort_is_due()) sort();
  p2g();            // Eqs 10–12   mass, momentum, impulse of the internal force
  update_grid(dt);  // Eqs 13–14   gravity, walls, obstacles
  g2p();            // Eqs 15–18   velocity, position, gradient; then the stress of each batch (Eqs 19–21)
  collect(dt);
}

template <class T, int Dim>
ExplicitStep<T, Dim>::ExplicitStep(const Model& model)
    : model_(model),
      kernels_(with_spline(model.method.basis, [&](auto nodes) { return step_kernels<T, Dim, nodes>(model.method); })),
      bodies_(model.bodies.size()),
      extent_(kernels_.block_extent(model.cells)),
      grid_(model_, kernels_),
      rest_(model.method.rest),
      supports_(kernels_.arena_size) {
  for (std::size_t d = 0; d < Dim; ++d) {
    domain_[d] = place_bounds(model, int(d));
    if (model.is_periodic(int(d))) blocks_.period[d] = model.cells[d] / BlockShape<Dim, 2>::B;
  }
  constants_ = {T(0), T(model.cell_size), T(model.method.flip_fraction), T(model.method.volume_averaging)};
  grid_.record_contact(model.account_energy);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    materials_.push_back(make_material_kernel<T, Dim>(model_.bodies[b].material));
    bodies_[b] = first_particles<T, Dim>(model_, model_.bodies[b], *materials_[b], numbers_.fastest);
    model_.bodies[b].initial = {};  // now in the particles
  }
  sort();
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::sort(std::vector<std::vector<std::uint32_t>>* orders) {
  const Timed timed(seconds_.sort);
  blocks_.tiles.clear(), tile_key_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    wrap(bodies_[b]);
    if (model_.has_open_face()) remove_leavers(bodies_[b]);
    kernels_.sort(bodies_[b], std::uint32_t(b), extent_, scratch_, blocks_.tiles, tile_key_);
    if (orders) orders->push_back(scratch_.order);
  }
  rebuild_blocks();
  numbers_.drift = 0, ++sorts_;
}

/// Moves particles that have passed a periodic face by whole domains, so that their base nodes are 0 … N − 1.
template <class T, int Dim>
void ExplicitStep<T, Dim>::wrap(Particles<T, Dim>& particles) const {
  for (std::size_t d = 0; d < Dim; ++d) {
    if (blocks_.period[d] == 0) continue;
    const double N = model_.cells[d];
    for (double& X : particles.position[d]) X -= N * std::floor((X - kernels_.base_shift) / N);
  }
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::rebuild_blocks() {
  kernels_.build_blocks(blocks_, tile_key_, extent_);
  arenas_.resize(blocks_.tiles.size() * kernels_.arena_size);
  reports_.resize(blocks_.tiles.size());
  grid_.rebuild(blocks_);
  rest_.rebuild(blocks_, tile_key_);
  if (!rest_.possible()) return;
  supports_.rebuild(blocks_.tiles.size());
  choose_work();
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::choose_work() {
  rest_.select(blocks_);
  parallel_for_host("jaxmpm::stop", rest_.stopped().size(), [&](std::size_t k) { stop(blocks_.tiles[rest_.stopped()[k]]); });
  grid_.select(blocks_, rest_.awake_blocks(), record_forces_);
  supports_.select(blocks_, grid_.summed(), [&](std::size_t t) { return rest_.rests(t); });
}

/// Takes all motion from the particles of a tile.
template <class T, int Dim>
void ExplicitStep<T, Dim>::stop(const Tile& tile) {
  Particles<T, Dim>& p = bodies_[tile.body];
  for (auto* rates : {&p.velocity, &p.affine, &p.gradient, &p.dilation})
    for (Array<T>& component : *rates) std::fill(component.begin() + tile.begin, component.begin() + tile.end, T(0));
}

template <class T, int Dim>
Index<Dim> ExplicitStep<T, Dim>::arena_origin(const Tile& tile) const {
  Index<Dim> origin;
  for (std::size_t d = 0; d < Dim; ++d) origin[d] = BlockShape<Dim, 2>::first_node(blocks_.index[tile.block][d]) - 1;
  return origin;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::p2g() {
  const Timed timed(seconds_.p2g);
  const std::vector<std::uint32_t>&moving = rest_.moving(), &supports = supports_.tiles();
  const auto arena = [&](std::size_t t) { return arenas_.data() + t * kernels_.arena_size; };
  parallel_for_host("jaxmpm::p2g", moving.size(), [&](std::size_t k) { scatter(moving[k], constants_, arena(moving[k])); });
  if (supports.empty()) return;
  StepConstants<T> unit = constants_;
  unit.dt = T(1);
  parallel_for_host("jaxmpm::supports", supports.size(), [&](std::size_t k) {
    const std::size_t t = supports[k];
    supports_.fill(t, constants_.dt, arena(t), [&](T* out) { scatter(t, unit, out); });
  });
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::scatter(std::size_t t, const StepConstants<T>& constants, T* arena) const {
  const Tile& tile = blocks_.tiles[t];
  kernels_.p2g(bodies_[tile.body], tile.begin, tile.end, *materials_[tile.body], constants, arena_origin(tile), arena);
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::update_grid(double dt) {
  const Timed timed(seconds_.grid);
  grid_.update(blocks_, arenas_.data(), dt, numbers_.time);
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::g2p() {
  const Timed timed(seconds_.g2p);
  const std::vector<std::uint32_t>& moving = rest_.moving();
  parallel_for_host("jaxmpm::g2p", moving.size(), [&](std::size_t k) {
    const std::uint32_t t = moving[k];
    const Tile& tile = blocks_.tiles[t];
    ParticleView<T, Dim> p(bodies_[tile.body]);
    reports_[t] = kernels_.g2p(p, tile, blocks_, grid_.grid(), *materials_[tile.body], constants_, model_.account_energy,
                               arena_origin(tile), domain_);
  });
}

/// Gathers what the tiles report, in their order.
template <class T, int Dim>
void ExplicitStep<T, Dim>::collect(double dt) {
  double moved = 0;
  bool sound = true;
  if (!blocks_.tiles.empty()) numbers_.fastest = rest_.fastest();  // else all have left, and the step stays as it was
  numbers_.last_dt = dt, numbers_.time += dt;
  for (const std::uint32_t t : rest_.moving()) {
    const TileReport& r = reports_[t];
    numbers_.fastest = std::max(numbers_.fastest, r.fastest), moved = std::max(moved, r.displacement);
    numbers_.dissipation.plastic += r.plastic, numbers_.dissipation.viscous += r.viscous;
    sound = sound && r.sound && r.inside;
  }
  if (!sound && !all_have_left()) report_failure();
  numbers_.drift += moved;
  if (model_.account_energy) numbers_.dissipation.friction += grid_.contact().friction;
  if (rest_.possible() && rest_.learn(reports_, dt, model_.cell_size)) choose_work();
}

/// Whether what is wrong with tiles is that particles have passed open faces, no more: these are taken out of the run.
template <class T, int Dim>
bool ExplicitStep<T, Dim>::all_have_left() {
  if (!model_.has_open_face()) return false;
  for (const std::uint32_t t : rest_.moving()) {
    const Tile& tile = blocks_.tiles[t];
    if (!reports_[t].sound) return false;
    if (reports_[t].inside) continue;
    release_leavers(model_, bodies_[tile.body], tile.begin, tile.end);
    check_particles<T, Dim>(model_, model_.bodies[tile.body], *materials_[tile.body], bodies_[tile.body], tile.begin, tile.end);
  }
  return true;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::report_failure() const {
  for (const std::uint32_t t : rest_.moving()) {
    if (reports_[t].sound && reports_[t].inside) continue;
    const Tile& tile = blocks_.tiles[t];
    check_particles<T, Dim>(model_, model_.bodies[tile.body], *materials_[tile.body], bodies_[tile.body], tile.begin, tile.end);
  }
  throw NumericsError("the state of a particle is not finite");
}

template <class T, int Dim>
double ExplicitStep<T, Dim>::stable_step() const {
  return jaxmpm::stable_step<T, Dim>(model_, materials_, numbers_.fastest);
}

template <class T, int Dim>
std::uint64_t ExplicitStep<T, Dim>::particle_count() const {
  std::uint64_t n = 0;
  for (const auto& p : bodies_) n += model_.has_open_face() ? all_slots(p, false).size() : p.count();
  return n;
}

template <class T, int Dim>
double ExplicitStep<T, Dim>::bytes_per_particle() const {
  double bytes = 0;
  for (const auto& p : bodies_) bytes += double(p.bytes_per_particle()) * double(p.count());
  return bytes / double(std::max<std::uint64_t>(particle_count(), 1));
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::record_forces(bool on) {
  record_forces_ = on;
  grid_.record_contact(on || model_.account_energy);
  if (rest_.possible()) choose_work();
}

template <class T, int Dim>
ContactForces ExplicitStep<T, Dim>::forces() const {
  ContactForces forces;
  forces.obstacle.resize(model_.obstacles.size());
  if (!record_forces_ || !(numbers_.last_dt > 0)) return forces;
  const BlockContact contact = grid_.contact();
  const double per_second = 1 / numbers_.last_dt + model_.method.damping;  // impulses are those on damped momenta
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t c = 0; c < 3; ++c) forces.face[f][c] = contact.face[f][c] * per_second;
  for (std::size_t o = 0; o < forces.obstacle.size(); ++o)
    for (std::size_t c = 0; c < 3; ++c) forces.obstacle[o][c] = contact.obstacle[o][c] * per_second;
  return forces;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::take_snapshot(const FieldSelection& fields, bool ordered, std::vector<BodySnapshot>& bodies) const {
  bodies.resize(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    take_body_snapshot<T, Dim>(model_, model_.bodies[b], *materials_[b], bodies_[b], fields, all_slots(bodies_[b], ordered), bodies[b]);
}

template <class T, int Dim>
std::vector<BodySnapshot> ExplicitStep<T, Dim>::snapshot_within(const std::vector<Region>& regions, const FieldSelection& fields) const {
  const std::vector<Slots> slots = slots_within(model_, blocks_, numbers_.drift, regions);
  std::vector<BodySnapshot> out(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    take_body_snapshot<T, Dim>(model_, model_.bodies[b], *materials_[b], bodies_[b], fields, slots[b], out[b]);
  return out;
}

template <class T, int Dim>
std::vector<RawArray> ExplicitStep<T, Dim>::save() const {
  std::vector<RawArray> arrays = save_state<T, Dim>(bodies_, blocks_.tiles, tile_key_, numbers_);
  if (rest_.possible()) arrays.push_back(rest_.save());
  return arrays;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::restore(const std::vector<RawArray>& arrays) {
  restore_state<T, Dim>(arrays, bodies_, blocks_.tiles, tile_key_, numbers_, model_.has_open_face());
  if (rest_.possible()) rest_.restore(arrays, blocks_.tiles, tile_key_);
  rebuild_blocks();
  ++sorts_;
}

template class ExplicitStep<float, 2>;
template class ExplicitStep<float, 3>;
template class ExplicitStep<double, 2>;
template class ExplicitStep<double, 3>;

}  // namespace jaxmpm
