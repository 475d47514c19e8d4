#pragma once
// Definitions of DeviceStep, to be instantiated for the execution spaces that a build has.
#include "core/error.hpp"
#include "solvers/device_grid_impl.hpp"
#include "solvers/device_step.hpp"

namespace jaxmpm {

/// One explicit step, stress updated last (Du & He 2025, Eqs 9–18).
template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::step(double dt) {
  constants_.dt = T(dt);
  sort_if_due();
  timer_.begin_step();
  p2g();                     // Eqs 10–12   mass, momentum, impulse of the internal force
  grid_.update(space_, dt);  // Eqs 13–14   gravity, walls, obstacles
  if (timer_.sampling()) space_.fence(), timer_.end_phase(&PhaseSeconds::grid);
  g2p();  // Eqs 15–18   velocity, position, gradient; then the stress (Eqs 19–21)
  collect(dt);
}

template <class T, int Dim, class Space>
DeviceStep<T, Dim, Space>::DeviceStep(const Model& model, const DeviceScheme<T, Dim, Space>& scheme)
    : model_(model), scheme_(scheme), extent_(scheme.block_extent(model.cells)), grid_(model_, scheme) {
  for (int d = 0; d < Dim; ++d) cells_[std::size_t(d)] = model.cells[std::size_t(d)];
  constants_ = {T(0), T(model.cell_size), T(model.method.flip_fraction)};
  report_ = DeviceArray<double, Space>("jaxmpm::report", StepReport::size);
  published_ = PinnedArray<double, Space>("jaxmpm::report", StepReport::size);
  SortScratch<T> scratch;
  for (Body& body : model_.bodies) {
    materials_.push_back(make_material_kernel<T, Dim>(body.material));
    Particles<T, Dim> particles = first_particles<T, Dim>(model_, body, *materials_.back(), numbers_.fastest);
    scheme_.sort(particles, std::uint32_t(bodies_.size()), extent_, scratch, blocks_.tiles, tile_key_);
    bodies_.push_back({DeviceParticles<T, Dim, Space>(particles), scheme_.body(body.material)});
    body.initial = {};  // now in the particles
  }
  rebuild();
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::sort_if_due() {
  if (!sort_is_due()) return;
  const Timed timed(sort_seconds_);
  sort();
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::sort() {
  std::vector<Tile> tiles;
  std::vector<std::int64_t> tile_key;
  numbers_ = numbers();  // the grid forgets the friction of its blocks
  if (!sort_on_device(tiles, tile_key)) sort_on_host(tiles, tile_key);
  blocks_.tiles = std::move(tiles), tile_key_ = std::move(tile_key);
  rebuild();
  numbers_.drift = 0;
  ++sorts_;
}

/// False where a particle has moved further than a block since the last sort.
template <class T, int Dim, class Space>
bool DeviceStep<T, Dim, Space>::sort_on_device(std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key) {
  std::vector<std::uint32_t> tile_block;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const DeviceBody& body = bodies_[b];
    const typename DeviceSort<T, Dim, Space>::Known known{grid_.tiles() + body.first_tile, grid_.tables().index, grid_.tables().neighbour};
    if (!sort_.sort(space_, bodies_[b].particles, std::uint32_t(b), blocks_, body.first_tile, body.tiles, known, scheme_.base_shift, tiles,
                    tile_block))
      return false;
  }
  for (const std::uint32_t block : tile_block) tile_key.push_back(block_key<Dim>(blocks_.index[block], extent_));
  return true;
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::sort_on_host(std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key) {
  SortScratch<T> scratch;
  tiles.clear(), tile_key.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Particles<T, Dim> particles = bodies_[b].particles.on_host();
    scheme_.sort(particles, std::uint32_t(b), extent_, scratch, tiles, tile_key);
    bodies_[b].particles.load(particles);
  }
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::rebuild() {
  scheme_.build_blocks(blocks_, tile_key_, extent_);
  grid_.rebuild(blocks_);
  for (DeviceBody& body : bodies_) body.tiles = 0;
  for (std::size_t t = blocks_.tiles.size(); t-- > 0;) {
    DeviceBody& body = bodies_[blocks_.tiles[t].body];
    body.first_tile = t, ++body.tiles;
  }
}

template <class T, int Dim, class Space>
TileTable<T, Dim> DeviceStep<T, Dim, Space>::tile_table(const DeviceBody& body) const {
  return {grid_.tiles() + body.first_tile, grid_.tables().index, grid_.arenas() + body.first_tile * scheme_.arena_size};
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::p2g() {
  for (const DeviceBody& body : bodies_) body.kernels->p2g(space_, body.tiles, body.particles.fields(), tile_table(body), constants_);
  if (timer_.sampling()) space_.fence(), timer_.end_phase(&PhaseSeconds::p2g);
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::g2p() {
  const GatherTables<T, Dim> from{grid_.tables().neighbour, grid_.tables().grid, cells_, model_.account_energy, report_.data()};
  for (const DeviceBody& body : bodies_) body.kernels->g2p(space_, body.tiles, body.particles.fields(), tile_table(body), constants_, from);
  if (timer_.sampling()) space_.fence(), timer_.end_phase(&PhaseSeconds::g2p);
}

/// Waits for the step and takes its report.
template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::collect(double dt) {
  parallel_for_on("jaxmpm::report", space_, 1, PublishReport{report_.data(), published_.data()});
  space_.fence();
  timer_.end_step();
  const double* report = published_.data();
  if (report[StepReport::unsound] != 0) report_failure();
  numbers_.fastest = report[StepReport::fastest], numbers_.last_dt = dt, numbers_.time += dt;
  numbers_.drift += report[StepReport::displacement];
  numbers_.dissipation.plastic += report[StepReport::plastic], numbers_.dissipation.viscous += report[StepReport::viscous];
  contact_known_ = record_forces_;
}

/// With the friction of the steps since the last sort, which the grid has.
template <class T, int Dim, class Space>
StepNumbers DeviceStep<T, Dim, Space>::numbers() const {
  StepNumbers all = numbers_;
  all.dissipation.friction += grid_.friction(space_);
  return all;
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::report_failure() const {
  const std::vector<Particles<T, Dim>> bodies = bodies_on_host();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    check_particles<T, Dim>(model_, model_.bodies[b], *materials_[b], bodies[b], 0, bodies[b].count());
  throw NumericsError("the state of a particle is not finite");
}

template <class T, int Dim, class Space>
double DeviceStep<T, Dim, Space>::stable_step() const {
  return jaxmpm::stable_step<T, Dim>(model_, materials_, numbers_.fastest);
}

template <class T, int Dim, class Space>
std::uint64_t DeviceStep<T, Dim, Space>::particle_count() const {
  std::uint64_t n = 0;
  for (const DeviceBody& body : bodies_) n += body.particles.count();
  return n;
}

template <class T, int Dim, class Space>
double DeviceStep<T, Dim, Space>::bytes_per_particle() const {
  double bytes = 0;
  for (const DeviceBody& body : bodies_) bytes += double(body.particles.bytes_per_particle()) * double(body.particles.count());
  return bytes / double(std::max<std::uint64_t>(particle_count(), 1));
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::record_forces(bool on) {
  record_forces_ = on, contact_known_ = contact_known_ && on;
  grid_.record_forces(on);
}

template <class T, int Dim, class Space>
ContactForces DeviceStep<T, Dim, Space>::forces() const {
  ContactForces forces;
  forces.obstacle.resize(model_.obstacles.size());
  if (!contact_known_) return forces;
  const std::vector<double> contact = grid_.contact(space_);
  const double per_second = 1 / numbers_.last_dt + model_.method.damping;  // impulses are those on damped momenta
  for (std::size_t k = 0; k < 6 + forces.obstacle.size(); ++k) {
    Point& force = k < 6 ? forces.face[k] : forces.obstacle[k - 6];
    for (std::size_t c = 0; c < 3; ++c) force[c] = contact[3 * k + c] * per_second;
  }
  return forces;
}

template <class T, int Dim, class Space>
std::vector<Particles<T, Dim>> DeviceStep<T, Dim, Space>::bodies_on_host() const {
  std::vector<Particles<T, Dim>> bodies;
  for (const DeviceBody& body : bodies_) bodies.push_back(body.particles.on_host());
  return bodies;
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::take_snapshot(const FieldSelection& fields, bool ordered, std::vector<BodySnapshot>& bodies) const {
  bodies.resize(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Particles<T, Dim> particles = bodies_[b].particles.on_host();
    take_body_snapshot<T, Dim>(model_, model_.bodies[b], *materials_[b], particles, fields, all_slots(particles, ordered), bodies[b]);
  }
}

/// Only the particles of the regions leave the device.
template <class T, int Dim, class Space>
std::vector<BodySnapshot> DeviceStep<T, Dim, Space>::snapshot_within(const std::vector<Region>& regions,
                                                                     const FieldSelection& fields) const {
  const std::vector<Slots> slots = slots_within(model_, blocks_, numbers_.drift, regions);
  std::vector<BodySnapshot> out(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Particles<T, Dim> particles = bodies_[b].particles.on_host(space_, slots[b]);
    take_body_snapshot<T, Dim>(model_, model_.bodies[b], *materials_[b], particles, fields, all_slots(particles, false), out[b]);
  }
  return out;
}

template <class T, int Dim, class Space>
std::vector<RawArray> DeviceStep<T, Dim, Space>::save() const {
  return save_state<T, Dim>(bodies_on_host(), blocks_.tiles, tile_key_, numbers());
}

template <class T, int Dim, class Space>
void DeviceStep<T, Dim, Space>::restore(const std::vector<RawArray>& arrays) {
  std::vector<Particles<T, Dim>> bodies = bodies_on_host();
  restore_state<T, Dim>(arrays, bodies, blocks_.tiles, tile_key_, numbers_);
  for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].particles.load(bodies[b]);
  contact_known_ = false;
  rebuild();
  ++sorts_;
}

}  // namespace jaxmpm
