#include "solvers/reversible_step.hpp"

#include <algorithm>
#include <cstring>

#include "core/parallel_host.hpp"
#include "core/round_up.hpp"
#include "solvers/particle_gradient.hpp"
#include "solvers/tile_motion.hpp"

namespace jaxmpm {
namespace {

/// Part of a field, and where it lies among the numbers of a kept state, in bytes.
struct Stretch {
  std::byte* field;
  std::size_t offset, size;
};

/// f(field, offset) for the fields of a kept state, each from a line of the cache on; returns their bytes. Lean: without what particles move
/// with, which comes last.
template <class Bodies, class F>
std::size_t for_each_kept_field(Bodies& bodies, bool lean, F f) {
  std::size_t offset = 0;
  const auto visit = [&](auto& field) {
    f(field, offset);
    offset += whole_lines(field.size() * sizeof(field[0]));
  };
  for (auto& p : bodies) p.for_each_material_field(visit);
  if (lean) return offset;
  for (auto& p : bodies) p.for_each_motion_field(visit);
  return offset;
}

/// In pieces that several threads can share.
template <class T, int Dim>
std::vector<Stretch> stretches(std::vector<Particles<T, Dim>>& bodies, bool lean) {
  constexpr std::size_t piece = std::size_t(1) << 15;
  std::vector<Stretch> all;
  for_each_kept_field(bodies, lean, [&](auto& field, std::size_t offset) {
    const std::size_t bytes = field.size() * sizeof(field[0]);
    for (std::size_t done = 0; done < bytes; done += piece)
      all.push_back({reinterpret_cast<std::byte*>(field.data()) + done, offset + done, std::min(piece, bytes - done)});
  });
  return all;
}

/// The bodies with the material's fields of a kept state, which are read only.
template <class T, int Dim>
std::vector<ParticleView<T, Dim>> kept_views(const std::vector<Particles<T, Dim>>& bodies, const std::byte* numbers) {
  std::vector<std::size_t> offsets;
  for_each_kept_field(bodies, true, [&](const auto&, std::size_t offset) { offsets.push_back(offset); });
  std::vector<ParticleView<T, Dim>> views(bodies.begin(), bodies.end());
  auto offset = offsets.begin();
  for (ParticleView<T, Dim>& view : views)
    view.for_each_material_field([&](auto& field) {
      using Field = std::decay_t<decltype(field)>;
      field = Field(reinterpret_cast<typename Field::Value*>(const_cast<std::byte*>(numbers + *offset++)));
    });
  return views;
}

template <class T, int Dim>
void clear_motion(std::vector<Particles<T, Dim>>& bodies) {
  for (Particles<T, Dim>& p : bodies) p.for_each_motion_field([](auto& field) { std::fill(field.begin(), field.end(), T(0)); });
}

template <class Copy>
void copy_stretches(const std::vector<Stretch>& stretches, Copy&& copy) {
  parallel_for_host_static("jaxmpm::keep", stretches.size(),
                           [&](std::size_t k) { copy(stretches[k].field, stretches[k].offset, stretches[k].size); });
}

/// Copies fields out of a kept state's numbers.
template <class T, int Dim>
void read_fields(std::vector<Particles<T, Dim>>& bodies, bool lean, const std::byte* numbers) {
  copy_stretches(stretches(bodies, lean),
                 [&](std::byte* field, std::size_t offset, std::size_t size) { std::memcpy(field, numbers + offset, size); });
}

}  // namespace

/// ExplicitStep::step(), read upwards. The nodes' velocities are needed, and come from the sums that were kept, or from a scatter as at
/// first. The last stage waits for the next call, which does it together with its own first where the state in between is the same for both:
/// what particles move with there is gathered in passing. That makes no difference to the numbers.
template <class T, int Dim>
void ReversibleStep<T, Dim>::step_adjoint(double dt, const KeptState& state, const std::byte* numbers) {
  const Kept& kept = static_cast<const Kept&>(state);
  Orders orders;
  bool sorted = false;
  if (waiting_ && kept.has_sums && kept.epoch == epoch_ && !(kept.numbers.drift > this->sort_after)) {
    const StepConstants<T> after = this->constants_;
    this->constants_.dt = T(dt);
    update_grid_again(kept, numbers, dt);
    between_steps_adjoint(after, numbers);
    present_ = numbers, present_is_lean_ = kept.lean;
    this->numbers_ = kept.numbers;
  } else {
    end_reverse();
    go_back(state, numbers);
    this->constants_.dt = T(dt);
    sorted = this->sort_is_due();
    if (sorted) this->sort(&orders);
    if (kept.has_sums) {
      update_grid_again(kept, numbers, dt);
    } else {
      this->p2g();
      this->update_grid(dt);
    }
    g2p_adjoint();  // Eqs 15–18 and the stress (19–21): by the particles' end values → by velocities of nodes, and by start values
  }
  update_grid_adjoint(dt);  // Eqs 13–14: by velocities → by sums of nodes
  waiting_ = kept.serial;
  if (!sorted && adjoint_.between_steps) return;
  end_reverse();  // Eqs 10–12: by sums of nodes → by the particles' start values
  if (sorted) unsort(orders);
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::end_reverse() {
  if (!waiting_) return;
  waiting_ = 0;
  read_present();
  p2g_adjoint();
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::read_present() {
  if (present_ == nullptr) return;
  read_fields(this->bodies_, present_is_lean_, present_);
  present_ = nullptr;
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::update_grid_again(const Kept& kept, const std::byte* numbers, double dt) {
  this->grid_.update_again(this->blocks_, numbers + particle_bytes(kept.lean), dt, kept.numbers.time);
}

template <class T, int Dim>
ReversibleStep<T, Dim>::ReversibleStep(const Model& model)
    : ExplicitStep<T, Dim>(model),
      adjoint_(with_spline(model.method.basis, [&](auto nodes) { return adjoint_kernels<T, Dim, nodes>(model.method); })),
      grid_adjoint_(this->model_, this->kernels_, adjoint_, this->grid_) {
  for (const Particles<T, Dim>& p : this->bodies_) {
    Array<T>& mass = mass_.emplace_back(p.count());
    const std::uint32_t first = p.first_id();
    for (std::size_t a = 0; a < p.count(); ++a) mass[p.id[a] - first] = p.mass[a];
  }
  for (const Body& body : model.bodies) material_adjoints_.push_back(make_material_adjoint<T, Dim>(body.material));
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::g2p_adjoint() {
  const auto& tiles = this->blocks_.tiles;
  g2p_reports_.assign(tiles.size(), {});
  parallel_for_host("jaxmpm::g2p_adjoint", tiles.size(), [&](std::size_t t) {
    const Tile& tile = tiles[t];
    ParticleView<T, Dim> bar(bars_[tile.body]);
    adjoint_.g2p(this->bodies_[tile.body], tile, this->blocks_, this->grid_.grid(), *material_adjoints_[tile.body], this->constants_,
                 this->arena_origin(tile), this->domain_, this->arenas_.data() + t * this->kernels_.arena_size, bar, g2p_reports_[t]);
  });
  add_g2p_reports();
  bars_move_ = false;
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::update_grid_adjoint(double dt) {
  grid_adjoint_.update(this->blocks_, this->arenas_.data(), dt, this->numbers_.time);
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::p2g_adjoint() {
  const auto& tiles = this->blocks_.tiles;
  p2g_reports_.assign(tiles.size(), {});
  parallel_for_host("jaxmpm::p2g_adjoint", tiles.size(), [&](std::size_t t) {
    const Tile& tile = tiles[t];
    ParticleView<T, Dim> bar(bars_[tile.body]);
    adjoint_.p2g(this->bodies_[tile.body], tile, this->blocks_, grid_adjoint_.by_sums(), *this->materials_[tile.body],
                 *material_adjoints_[tile.body], this->constants_, this->arena_origin(tile), bar, p2g_reports_[t]);
  });
  add_p2g_reports();
}

/// p2g_adjoint() of the step from the present state, whose constants are `after`, and g2p_adjoint() of the step before it, from a state of
/// these numbers.
template <class T, int Dim>
void ReversibleStep<T, Dim>::between_steps_adjoint(const StepConstants<T>& after, const std::byte* numbers) {
  const auto& tiles = this->blocks_.tiles;
  using Motion = TileMotion<T, Dim>;
  using Views = std::vector<ParticleView<T, Dim>>;
  const Views present = present_ != nullptr ? kept_views(this->bodies_, present_) : Views(this->bodies_.begin(), this->bodies_.end());
  const Views before = kept_views(this->bodies_, numbers);
  p2g_reports_.assign(tiles.size(), {}), g2p_reports_.assign(tiles.size(), {});
  parallel_for_host("jaxmpm::between_steps_adjoint", tiles.size(), [&](std::size_t t) {
    const Tile& tile = tiles[t];
    static thread_local Motion motion, by_motion;
    ParticleView<T, Dim> p = present[tile.body], bar(bars_[tile.body]);
    motion.lend(tile, p, Motion::Start::anything);
    by_motion.lend(tile, bar, bars_move_ ? Motion::Start::copy : Motion::Start::zero);
    adjoint_.between_steps(p, before[tile.body], tile, this->blocks_, *this->materials_[tile.body], *material_adjoints_[tile.body],
                           this->arena_origin(tile), this->domain_, this->arenas_.data() + t * this->kernels_.arena_size, bar,
                           {after, this->constants_, grid_adjoint_.by_sums(), this->grid_.grid(), p2g_reports_[t], g2p_reports_[t]});
  });
  if (bars_move_) clear_motion(bars_);
  bars_move_ = false;
  add_p2g_reports();
  add_g2p_reports();
}

/// Puts the derivatives back into the order that the particles had before the sort.
template <class T, int Dim>
void ReversibleStep<T, Dim>::unsort(const Orders& orders) {
  for (std::size_t b = 0; b < bars_.size(); ++b)
    bars_[b].for_each_field([&](const std::string&, auto& field) {
      if (field.empty()) return;
      const std::decay_t<decltype(field)> sorted(field);
      for (std::size_t a = 0; a < field.size(); ++a) field[orders[b][a]] = sorted[a];
    });
}

/// Adds up what a tile reports of its material.
template <class T, int Dim>
void ReversibleStep<T, Dim>::add_report(std::size_t tile, const MaterialReport& report) {
  MaterialReport& total = material_totals_[this->blocks_.tiles[tile].body];
  for (std::size_t k = 0; k < total.constants.size(); ++k) total.constants[k] += report.constants[k];
  total.at_kinks += report.at_kinks;
}

/// Add up what the tiles report, in their order.
template <class T, int Dim>
void ReversibleStep<T, Dim>::add_g2p_reports() {
  for (std::size_t t = 0; t < g2p_reports_.size(); ++t)
    add_report(t, g2p_reports_[t].material), flip_fraction_ += g2p_reports_[t].flip_fraction;
}
template <class T, int Dim>
void ReversibleStep<T, Dim>::add_p2g_reports() {
  for (std::size_t t = 0; t < p2g_reports_.size(); ++t) add_report(t, p2g_reports_[t]);
}

template <class T, int Dim>
std::uint64_t ReversibleStep<T, Dim>::at_kinks() const {
  std::uint64_t sum = 0;
  for (const MaterialReport& total : material_totals_) sum += total.at_kinks;
  return sum;
}

template <class T, int Dim>
std::size_t ReversibleStep<T, Dim>::particle_bytes(bool lean) const {  // where the sums begin
  return for_each_kept_field(this->bodies_, lean, [](const auto&, std::size_t) {});
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::expect_blocks(std::size_t most) {
  room_for_sums_ = this->grid_.packed_bytes(most);
  this->grid_.keep_sums();
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::keep_sums(KeptState& state, std::byte* numbers) {
  if (this->grid_.packed_bytes(this->blocks_.count()) > room_for_sums_) return;
  Kept& kept = static_cast<Kept&>(state);
  this->grid_.pack_sums(numbers + particle_bytes(kept.lean));
  kept.has_sums = true;
  sums_kept_ = true;
}

template <class T, int Dim>
std::size_t ReversibleStep<T, Dim>::shared_bytes() const {
  std::size_t bytes = this->blocks_.tiles.size() * (sizeof(Tile) + sizeof(std::int64_t));
  for (const Particles<T, Dim>& p : this->bodies_) bytes += p.count() * sizeof(std::uint32_t);
  return bytes;
}

template <class T, int Dim>
auto ReversibleStep<T, Dim>::present_epoch() -> std::shared_ptr<const Epoch> {
  if (epoch_sorts_ == this->sorts_) return epoch_;
  auto epoch = std::make_shared<Epoch>();
  for (const Particles<T, Dim>& p : this->bodies_) epoch->id.push_back(p.id);
  epoch->tiles = this->blocks_.tiles, epoch->tile_key = this->tile_key_;
  epoch_ = std::move(epoch), epoch_sorts_ = this->sorts_;
  return epoch_;
}

template <class T, int Dim>
bool ReversibleStep<T, Dim>::may_be_lean() const {
  return adjoint_.between_steps && sums_kept_ && kept_sorts_ == this->sorts_ && !this->sort_is_due();
}

template <class T, int Dim>
std::unique_ptr<KeptState> ReversibleStep<T, Dim>::keep(std::byte* numbers, bool lean) {
  end_reverse();
  auto kept = std::make_unique<Kept>();
  kept->lean = lean;
  copy_stretches(stretches(this->bodies_, lean),
                 [&](std::byte* field, std::size_t offset, std::size_t size) { std::memcpy(numbers + offset, field, size); });
  kept->epoch = present_epoch(), kept->numbers = this->numbers_, kept->serial = ++serials_;
  kept_sorts_ = this->sorts_, sums_kept_ = false;
  return kept;
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::go_back(const KeptState& state, const std::byte* numbers) {
  const Kept& kept = static_cast<const Kept&>(state);
  if (waiting_ == kept.serial) return read_present();  // it is the present one
  end_reverse();
  read_fields(this->bodies_, kept.lean, numbers);
  this->numbers_ = kept.numbers, sums_kept_ = false;
  if (kept.epoch == epoch_ && epoch_sorts_ == this->sorts_) return;
  epoch_ = kept.epoch, epoch_sorts_ = this->sorts_;
  for (std::size_t b = 0; b < this->bodies_.size(); ++b) {
    Particles<T, Dim>& p = this->bodies_[b];
    p.id = epoch_->id[b];
    const std::uint32_t first = p.first_id();
    for (std::size_t a = 0; a < p.count(); ++a) p.mass[a] = mass_[b][p.id[a] - first];
  }
  this->blocks_.tiles = epoch_->tiles, this->tile_key_ = epoch_->tile_key;
  this->rebuild_blocks();
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::start_reverse() {
  this->grid_.keep_sums();
  grid_adjoint_.clear_bars();
  material_totals_.assign(this->bodies_.size(), {});
  flip_fraction_ = 0, waiting_ = 0, present_ = nullptr, bars_move_ = false;
  bars_.clear();
  for (const Particles<T, Dim>& p : this->bodies_) bars_.push_back(zero_bars(p));
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::add_gradient(const SnapshotGradient& by) {
  bars_move_ = true;
  for (std::size_t b = 0; b < by.size(); ++b) {
    add_body_gradient(b, by[b]);
    if (!by[b].stress.empty()) add_stress_gradient(b, by[b]);
  }
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::add_body_gradient(std::size_t b, const BodySnapshot& by) {
  const Particles<T, Dim>& p = this->bodies_[b];
  Particles<T, Dim>& bar = bars_[b];
  const std::uint32_t first = p.first_id();
  const double rho0 = double(this->materials_[b]->reference_density()), h = this->model_.cell_size;
  const int strain = this->materials_[b]->plastic_strain_index();
  for (std::size_t a = 0; a < p.count(); ++a) {
    const std::size_t i = p.id[a] - first;
    for (std::size_t d = 0; d < Dim; ++d) {
      if (!by.position.empty()) bar.position[d][a] += h * by.position[i * Dim + d];
      if (!by.velocity.empty()) bar.velocity[d][a] += T(by.velocity[i * Dim + d]);
    }
    if (!by.mass.empty()) bar.mass[a] += T(by.mass[i]);
    if (!by.plastic_strain.empty() && strain >= 0) bar.history[std::size_t(strain)][a] += T(by.plastic_strain[i]);
    if (by.density.empty()) continue;
    bar.compression[a] += T(rho0 * by.density[i]);  // ρ = ρ0 (1 + e)
    material_totals_[b].constants[0] += (1 + double(p.compression[a])) * by.density[i];
  }
}

template <class T, int Dim>
void ReversibleStep<T, Dim>::add_stress_gradient(std::size_t b, const BodySnapshot& by) {
  constexpr int W = native_lanes<T>, size = Symmetric<T, Dim>::size;
  const Particles<T, Dim>& p = this->bodies_[b];
  const ParticleView<T, Dim> view(p);
  ParticleView<T, Dim> bar(bars_[b]);
  const std::uint32_t first = p.first_id();
  for (std::size_t s = 0; s < p.count(); s += W) {
    const int count = int(std::min<std::size_t>(W, p.count() - s));
    alignas(64) T by_sigma[size][W] = {};
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < size; ++k) by_sigma[k][l] = T(by.stress[(p.id[s + std::size_t(l)] - first) * 6 + std::size_t(k)]);
    material_adjoints_[b]->stress(view, s, count, by_sigma, bar, material_totals_[b]);
  }
}

template <class T, int Dim>
ModelGradient ReversibleStep<T, Dim>::gradient() const {
  ModelGradient g;
  const GridBars& grid = grid_adjoint_.bars();
  g.gravity = grid.gravity, g.damping = grid.damping, g.body_force = grid.body_force, g.wall_velocity = grid.wall_velocity;
  g.obstacle_coefficient = grid.obstacle, g.flip_fraction = flip_fraction_;
  g.coefficient = by_face(this->model_, grid.segment.data());
  for (std::size_t b = 0; b < bars_.size(); ++b)
    g.bodies.push_back(body_gradient(this->model_.bodies[b], *material_adjoints_[b], this->bodies_[b], bars_[b], material_totals_[b]));
  return g;
}

template class ReversibleStep<float, 2>;
template class ReversibleStep<float, 3>;
template class ReversibleStep<double, 2>;
template class ReversibleStep<double, 3>;

}  // namespace jaxmpm
