#include "solvers/explicit_step.hpp"

#include <chrono>
#include <sstream>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace jaxmpm {
namespace {

/// Adds the time of a scope to a phase.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_;
};

template <class T, int Dim>
StepKernels<T, Dim> choose_kernels(const deck::Method& method) {
  switch (method.basis) {
    case deck::Basis::linear:
      return step_kernels<T, Dim, 2>(method.transfer, method.gradient);
    case deck::Basis::quadratic:
      return step_kernels<T, Dim, 3>(method.transfer, method.gradient);
    case deck::Basis::cubic:
      break;
  }
  return step_kernels<T, Dim, 4>(method.transfer, method.gradient);
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
      kernels_(choose_kernels<T, Dim>(model.method)),
      bodies_(model.bodies.size()),
      extent_(kernels_.block_extent(model.cells)),
      grid_(model_, kernels_) {
  for (int d = 0; d < Dim; ++d) domain_.cells[std::size_t(d)] = model.cells[std::size_t(d)];
  constants_ = {T(0), T(model.cell_size), T(model.method.flip_fraction)};
  grid_.record_contact(model.account_energy);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    materials_.push_back(make_material_kernel<T, Dim>(model_.bodies[b].material));
    seed(b);
    model_.bodies[b].initial = {};  // now in the particles
  }
  sort();
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::seed(std::size_t body) {
  const BodyState& initial = model_.bodies[body].initial;
  const MaterialKernel<T, Dim>& material = *materials_[body];
  Particles<T, Dim>& p = bodies_[body];
  const std::size_t n = initial.id.size(), history = std::size_t(material.history_size());
  const bool affine = model_.method.transfer == deck::Transfer::apic || model_.method.transfer == deck::Transfer::tpic;
  const auto zeros = [&](std::size_t arrays) { return std::vector<Array<T>>(arrays, Array<T>(n, T(0))); };
  p.position.assign(Dim, Array<double>(n)), p.velocity = zeros(Dim);
  p.mass.resize(n), p.compression.resize(n), p.id.assign(initial.id.begin(), initial.id.end());
  p.affine = zeros(affine ? Dim * Dim : 0), p.history = zeros(history);
  p.gradient = zeros(model_.record_velocity_gradient ? Dim * Dim : 0);
  std::vector<double> h(history + 1);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t d = 0; d < Dim; ++d) p.position[d][a] = initial.position[a][d], p.velocity[d][a] = T(initial.velocity[a][d]);
    p.mass[a] = T(initial.mass[a]), p.compression[a] = T(initial.compression[a]);
    const std::array<double, 6> stress = initial.stress.empty() ? std::array<double, 6>{} : initial.stress[a];
    material.start(stress.data(), initial.compression[a], h.data());
    for (std::size_t k = 0; k < history; ++k) p.history[k][a] = T(h[k]);
    double speed2 = 0;
    for (std::size_t d = 0; d < Dim; ++d) speed2 += initial.velocity[a][d] * initial.velocity[a][d];
    fastest_ = std::max(fastest_, std::sqrt(speed2) + material.wave_speed(initial.compression[a], h.data()));
  }
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::sort() {
  const Stopwatch time(seconds_.sort);
  blocks_.tiles.clear(), tile_key_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) kernels_.sort(bodies_[b], std::uint32_t(b), extent_, scratch_, blocks_.tiles, tile_key_);
  rebuild_blocks();
  drift_ = 0;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::rebuild_blocks() {
  kernels_.build_blocks(blocks_, tile_key_, extent_);
  arenas_.resize(blocks_.tiles.size() * kernels_.arena_size);
  reports_.resize(blocks_.tiles.size());
  grid_.rebuild(blocks_);
}

template <class T, int Dim>
Index<Dim> ExplicitStep<T, Dim>::arena_origin(const Tile& tile) const {
  Index<Dim> origin;
  for (std::size_t d = 0; d < Dim; ++d) origin[d] = BlockShape<Dim, 2>::first_node(blocks_.index[tile.block][d]) - 1;
  return origin;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::p2g() {
  const Stopwatch time(seconds_.p2g);
  parallel_for_host("jaxmpm::p2g", blocks_.tiles.size(), [&](std::size_t t) {
    const Tile& tile = blocks_.tiles[t];
    kernels_.p2g(bodies_[tile.body], tile.begin, tile.end, *materials_[tile.body], constants_, arena_origin(tile),
                 arenas_.data() + t * kernels_.arena_size);
  });
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::update_grid(double dt) {
  const Stopwatch time(seconds_.grid);
  grid_.update(blocks_, arenas_.data(), dt);
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::g2p() {
  const Stopwatch time(seconds_.g2p);
  parallel_for_host("jaxmpm::g2p", blocks_.tiles.size(), [&](std::size_t t) {
    const Tile& tile = blocks_.tiles[t];
    reports_[t] = kernels_.g2p(bodies_[tile.body], tile, blocks_, grid_.grid(), *materials_[tile.body], constants_, model_.account_energy,
                               arena_origin(tile), domain_);
  });
}

/// Gathers what the tiles report, in their order.
template <class T, int Dim>
void ExplicitStep<T, Dim>::collect(double dt) {
  double moved = 0;
  bool sound = true;
  fastest_ = 0, last_dt_ = dt;
  for (const TileReport& r : reports_) {
    fastest_ = std::max(fastest_, r.fastest), moved = std::max(moved, r.displacement);
    dissipation_.plastic += r.plastic, dissipation_.viscous += r.viscous;
    sound = sound && r.sound;
  }
  if (!sound) report_failure();
  drift_ += moved;
  if (model_.account_energy) dissipation_.friction += grid_.contact().friction;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::report_failure() const {
  for (std::size_t t = 0; t < reports_.size(); ++t) {
    if (reports_[t].sound) continue;
    const Tile& tile = blocks_.tiles[t];
    const Particles<T, Dim>& p = bodies_[tile.body];
    for (std::size_t a = tile.begin; a < tile.end; ++a) {
      bool inside = true, finite = std::isfinite(p.compression[a]) && p.compression[a] > T(-1) && p.compression[a] < T(1e6);
      std::ostringstream place;
      for (std::size_t d = 0; d < Dim; ++d) {
        const double X = p.position[d][a];
        inside = inside && X >= 0 && X <= domain_.cells[d], finite = finite && std::isfinite(X) && std::isfinite(p.velocity[d][a]);
        place << (d ? ", " : "") << model_.domain_min[d] + X * model_.cell_size;
      }
      for (const auto& h : p.history) finite = finite && std::isfinite(h[a]);
      if (inside && finite) continue;
      std::ostringstream text;
      text << "particle " << p.id[a] << " of body \"" << model_.bodies[tile.body].name << "\" at (" << place.str() << ") "
           << (finite ? "has left the domain" : "has a state that is not finite");
      throw NumericsError(text.str());
    }
  }
  throw NumericsError("a wave speed is not finite");
}

template <class T, int Dim>
double ExplicitStep<T, Dim>::stable_step() const {
  const double h = model_.cell_size;
  double dt = model_.time.cfl * h / std::max(fastest_, 1e-300);
  for (const auto& material : materials_)
    if (material->diffusivity() > 0) dt = std::min(dt, model_.time.cfl * h * h / (2 * Dim * material->diffusivity()));
  return dt;
}

template <class T, int Dim>
std::uint64_t ExplicitStep<T, Dim>::particle_count() const {
  std::uint64_t n = 0;
  for (const auto& p : bodies_) n += p.count();
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
}

template <class T, int Dim>
ContactForces ExplicitStep<T, Dim>::forces() const {
  ContactForces forces;
  forces.obstacle.resize(model_.obstacles.size());
  if (!record_forces_ || !(last_dt_ > 0)) return forces;
  const BlockContact contact = grid_.contact();
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t c = 0; c < 3; ++c) forces.face[f][c] = contact.face[f][c] / last_dt_;
  for (std::size_t o = 0; o < forces.obstacle.size(); ++o)
    for (std::size_t c = 0; c < 3; ++c) forces.obstacle[o][c] = contact.obstacle[o][c] / last_dt_;
  return forces;
}

template class ExplicitStep<float, 2>;
template class ExplicitStep<float, 3>;
template class ExplicitStep<double, 2>;
template class ExplicitStep<double, 3>;

}  // namespace jaxmpm
