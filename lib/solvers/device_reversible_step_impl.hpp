#pragma once
// Definitions of DeviceReversibleStep, to be instantiated for the execution spaces that a build has.
#include "solvers/device_reversible_step.hpp"
#include "solvers/device_step_impl.hpp"
#include "solvers/particle_gradient.hpp"

namespace jaxmpm {

/// DeviceStep::step(), read upwards. The nodes' velocities come from a scatter, as at first.
template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::step_adjoint(double dt, const KeptState& state, const std::byte* numbers) {
  go_back(state, numbers);
  this->constants_.dt = T(dt);
  const bool sorted = this->sort_is_due();
  if (sorted) note_places(), this->sort();
  this->p2g();
  this->grid_.update(this->space_, dt);

  g2p_adjoint();     // Eqs 15–18 and the stress (19–21): by the particles' end values → by velocities of nodes, and by start values
  grid_adjoint(dt);  // Eqs 13–14: by velocities → by sums of nodes
  p2g_adjoint();     // Eqs 10–12: by sums of nodes → by the particles' start values
  if (sorted) unsort();
}

template <class T, int Dim, class Space>
DeviceReversibleStep<T, Dim, Space>::DeviceReversibleStep(const Model& model, const DeviceScheme<T, Dim, Space>& scheme,
                                                          const DeviceAdjoint<T, Dim, Space>& adjoint)
    : DeviceStep<T, Dim, Space>(model, scheme),
      adjoint_(adjoint),
      places_{int(this->grid_.segments()), int(model.obstacles.size())},
      constant_bars_(device_array<double, Space>("jaxmpm::constant_bars", std::size_t(places_.body(model.bodies.size())))) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Particles<T, Dim> particles = this->bodies_[b].particles.on_host();
    Particles<T, Dim> zeros = zero_bars(particles);
    zeros.id = particles.id;
    Bars bars{DeviceParticles<T, Dim, Space>(zeros),
              adjoint.body(model.bodies[b].material),
              make_material_adjoint<T, Dim>(model.bodies[b].material),
              {},
              {},
              particles.first_id()};
    const std::size_t stride = this->bodies_[b].particles.fields().stride;
    bars.gathered = device_array<T, Space>("jaxmpm::gathered_bars", adjoint_.gathered_rows * stride);
    bars.place = device_array<std::uint32_t, Space>("jaxmpm::places", particles.count());
    bars_.push_back(std::move(bars));
  }
}

template <class T, int Dim, class Space>
BodyBars<T, Dim> DeviceReversibleStep<T, Dim, Space>::tables(std::size_t b) const {
  double* constants = constant_bars_.data();
  return {this->bodies_[b].particles.fields(), bars_[b].fields.fields(), bars_[b].gathered.data(), constants + ConstantBars::flip_fraction,
          constants + places_.body(b)};
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::g2p_adjoint() {
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto& body = this->bodies_[b];
    bars_[b].kernels->g2p(this->space_, body.tiles, tables(b), this->tile_table(body), this->constants_, this->grid_.tables().neighbour,
                          this->grid_.tables().grid, this->cells_);
  }
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::grid_adjoint(double dt) {
  const GridTables<T, Dim>& grid = this->grid_.tables();
  grow<T>(by_sums_, "jaxmpm::grid_bars", grid.blocks * this->scheme_.own_size);
  grow<T>(by_velocity_, "jaxmpm::grid_bars", grid.wall_blocks * std::size_t(BlockShape<Dim, 2>::cells) * 4);
  const double slowing = 1 + this->model_.method.damping * dt;  // the part taken is ζΔt/(1 + ζΔt)
  const GridBarTables<T> to{by_sums_.data(), by_velocity_.data(), constant_bars_.data(), places_, dt, dt / (slowing * slowing)};
  adjoint_.grid(this->space_, grid, this->grid_.constants(dt), to);
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::p2g_adjoint() {
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto& body = this->bodies_[b];
    bars_[b].kernels->p2g(this->space_, body.tiles, tables(b), this->tile_table(body), this->constants_, this->grid_.tables().neighbour,
                          by_sums_.data());
  }
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::note_places() {
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto& particles = this->bodies_[b].particles;
    parallel_for_on("jaxmpm::places", this->space_, particles.count(),
                    NotePlaces{particles.fields().ids, bars_[b].first_id, bars_[b].place.data()});
  }
}

/// Puts the derivatives back into the order that the particles had before the sort.
template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::unsort() {
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    const auto& particles = this->bodies_[b].particles;
    Bars& bars = bars_[b];
    parallel_for_on("jaxmpm::unsort", this->space_, particles.count(),
                    Unsort<T, Dim>{bars.fields.fields(), bars.fields.spare(), particles.fields().ids, bars.place.data(), bars.first_id,
                                   bars.fields.rows()});
    bars.fields.swap();
  }
}

template <class T, int Dim, class Space>
std::size_t DeviceReversibleStep<T, Dim, Space>::kept_bytes() const {
  std::size_t bytes = 0;
  for (const auto& body : this->bodies_) bytes += body.particles.kept_bytes();
  return bytes;
}

template <class T, int Dim, class Space>
std::size_t DeviceReversibleStep<T, Dim, Space>::shared_bytes() const {
  return std::size_t(this->particle_count()) * sizeof(std::uint32_t);
}

template <class T, int Dim, class Space>
auto DeviceReversibleStep<T, Dim, Space>::present_epoch() -> std::shared_ptr<const Epoch> {
  if (epoch_sorts_ == this->sorts_) return epoch_;
  auto epoch = std::make_shared<Epoch>();
  for (const auto& body : this->bodies_) epoch->id.push_back(body.particles.copy_of_ids(this->space_));
  epoch->tiles = this->blocks_.tiles, epoch->tile_key = this->tile_key_;
  epoch_ = std::move(epoch), epoch_sorts_ = this->sorts_;
  return epoch_;
}

template <class T, int Dim, class Space>
std::unique_ptr<KeptState> DeviceReversibleStep<T, Dim, Space>::keep(std::byte* numbers, bool) {
  for (const auto& body : this->bodies_) {
    body.particles.keep(this->space_, numbers);
    numbers += body.particles.kept_bytes();
  }
  auto kept = std::make_unique<Kept>();
  kept->epoch = present_epoch(), kept->numbers = this->numbers_;
  return kept;
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::go_back(const KeptState& state, const std::byte* numbers) {
  const Kept& kept = static_cast<const Kept&>(state);
  for (auto& body : this->bodies_) {
    body.particles.go_back(this->space_, numbers);
    numbers += body.particles.kept_bytes();
  }
  this->numbers_ = kept.numbers;
  if (kept.epoch == epoch_ && epoch_sorts_ == this->sorts_) return;
  epoch_ = kept.epoch, epoch_sorts_ = this->sorts_;
  for (std::size_t b = 0; b < this->bodies_.size(); ++b) this->bodies_[b].particles.set_ids(this->space_, epoch_->id[b]);
  this->blocks_.tiles = epoch_->tiles, this->tile_key_ = epoch_->tile_key;
  this->space_.fence();
  this->rebuild();
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::start_reverse() {
  this->grid_.keep_sums();
  for (Bars& bars : bars_) bars.fields.clear(this->space_);
  Kokkos::deep_copy(this->space_, constant_bars_, 0.0);
}

template <class T, int Dim, class Space>
void DeviceReversibleStep<T, Dim, Space>::add_gradient(const SnapshotGradient& by) {
  for (std::size_t b = 0; b < by.size(); ++b) {
    std::array<DeviceArray<double, Space>, 6> arrays;
    const std::array<const std::vector<double>*, 6> from{&by[b].position, &by[b].velocity,       &by[b].mass,
                                                         &by[b].density,  &by[b].plastic_strain, &by[b].stress};
    std::array<const double*, 6> to{};
    for (std::size_t k = 0; k < from.size(); ++k)
      if (!from[k]->empty()) mirror(arrays[k], "jaxmpm::snapshot_bars", *from[k]), to[k] = arrays[k].data();
    bars_[b].kernels->add_snapshot(this->space_, this->bodies_[b].particles.count(), tables(b), {to[0], to[1], to[2], to[3], to[4], to[5]},
                                   bars_[b].first_id, this->model_.cell_size);
    this->space_.fence();  // before the arrays go
  }
}

template <class T, int Dim, class Space>
std::vector<double> DeviceReversibleStep<T, Dim, Space>::constants() const {
  this->space_.fence();
  std::vector<double> found(constant_bars_.extent(0));
  copy_out(found.data(), constant_bars_, 0, found.size());
  return found;
}

template <class T, int Dim, class Space>
ModelGradient DeviceReversibleStep<T, Dim, Space>::gradient() const {
  const std::vector<double> found = constants();
  ModelGradient g;
  for (std::size_t c = 0; c < 3; ++c) g.gravity[c] = found[ConstantBars::gravity + c];
  g.damping = found[ConstantBars::damping], g.flip_fraction = found[ConstantBars::flip_fraction];
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t c = 0; c < 3; ++c) g.wall_velocity[f][c] = found[ConstantBars::wall_velocity + 3 * f + c];
  g.coefficient = by_face(this->model_, &found[ConstantBars::segment]);
  const double* obstacles = &found[std::size_t(places_.obstacle())];
  g.obstacle_coefficient.assign(obstacles, obstacles + places_.obstacles);
  for (std::size_t b = 0; b < bars_.size(); ++b) {
    MaterialReport report;
    std::copy_n(&found[std::size_t(places_.body(b))], report.constants.size(), report.constants.begin());
    g.bodies.push_back(
        body_gradient(this->model_.bodies[b], *bars_[b].material, this->bodies_[b].particles.on_host(), bars_[b].fields.on_host(), report));
  }
  return g;
}

template <class T, int Dim, class Space>
std::uint64_t DeviceReversibleStep<T, Dim, Space>::at_kinks() const {
  const std::vector<double> found = constants();
  double sum = 0;
  for (std::size_t b = 0; b < bars_.size(); ++b) sum += found[std::size_t(places_.body(b) + ConstantBars::kinks)];
  return std::uint64_t(sum);
}

}  // namespace jaxmpm
