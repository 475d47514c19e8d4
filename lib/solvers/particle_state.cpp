#include "solvers/particle_state.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "core/error.hpp"
#include "core/parallel_host.hpp"
#include "core/round_up.hpp"
#include "kernels/wall_node.hpp"
#include "solvers/raw_array.hpp"

namespace jaxmpm {
namespace {

std::string field_name(std::size_t body, const std::string& field) { return "body" + std::to_string(body) + "_" + field; }

/// Gives room for so many particles, or takes it.
template <class T, int Dim>
void resize(Particles<T, Dim>& particles, std::size_t count) {
  particles.for_each_field([count](const std::string&, auto& field) { field.resize(count); });
}

}  // namespace

template <class T, int Dim>
Particles<T, Dim> first_particles(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, double& fastest) {
  const BodyState& initial = body.initial;
  Particles<T, Dim> p;
  const std::size_t n = initial.id.size(), history = std::size_t(material.history_size());
  const bool affine = model.method.transfer == deck::Transfer::apic || model.method.transfer == deck::Transfer::tpic;
  const auto zeros = [&](std::size_t arrays) { return std::vector<Array<T>>(arrays, Array<T>(n, T(0))); };
  p.position.assign(Dim, Array<double>(n)), p.velocity = zeros(Dim);
  p.mass.resize(n), p.compression.resize(n), p.id.assign(initial.id.begin(), initial.id.end());
  p.affine = zeros(affine ? Dim * Dim : 0), p.history = zeros(history);
  p.dilation = zeros(model.method.volume_averaging > 0 ? 1 : 0);
  p.gradient = zeros(model.record_velocity_gradient ? Dim * Dim : 0);
  std::vector<double> h(history + 1);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t d = 0; d < Dim; ++d) p.position[d][a] = initial.position[a][d], p.velocity[d][a] = T(initial.velocity[a][d]);
    p.mass[a] = T(initial.mass[a]), p.compression[a] = T(initial.compression[a]);
    const std::array<double, 6> stress = initial.stress.empty() ? std::array<double, 6>{} : initial.stress[a];
    material.start(stress.data(), initial.compression[a], h.data());
    for (std::size_t k = 0; k < history; ++k) p.history[k][a] = T(h[k]);
    double speed2 = 0;
    for (std::size_t d = 0; d < Dim; ++d) speed2 += initial.velocity[a][d] * initial.velocity[a][d];
    fastest = std::max(fastest, std::sqrt(speed2) + material.wave_speed(initial.compression[a], h.data()));
  }
  return p;
}

template <class T, int Dim>
double stable_step(const Model& model, const MaterialKernels<T, Dim>& materials, double fastest) {
  const double h = model.cell_size;
  double dt = model.time.cfl * h / std::max(fastest, 1e-300);
  for (const auto& material : materials)
    if (material->diffusivity() > 0) dt = std::min(dt, model.time.cfl * h * h / (2 * Dim * material->diffusivity()));
  return dt;
}

template <class T, int Dim>
Slots all_slots(const Particles<T, Dim>& p, bool ordered) {
  Slots slots(p.count());
  std::size_t there = 0;
  for (std::size_t a = 0; a < p.count(); ++a) {
    slots[there] = std::uint32_t(a);
    there += p.mass[a] > T(0);
  }
  slots.resize(there);
  if (!ordered || slots.empty()) return slots;
  constexpr std::uint32_t none = ~std::uint32_t(0);
  const std::uint32_t first = p.first_id();
  Slots by_id(1 + *std::max_element(p.id.begin(), p.id.end()) - first, none);  // no longer than the body was at first
  for (const std::uint32_t a : slots) by_id[p.id[a] - first] = a;
  by_id.erase(std::remove(by_id.begin(), by_id.end(), none), by_id.end());
  return by_id;
}

template <int Dim>
std::vector<Slots> slots_within(const Model& model, const Blocks<Dim>& blocks, double drift, const std::vector<Region>& regions) {
  constexpr int B = BlockShape<Dim, 2>::B;
  const auto may_hold = [&](const Region& region, const Index<Dim>& first) {
    for (std::size_t d = 0; d < Dim; ++d) {
      if (model.is_periodic(int(d))) continue;
      const double low = (region.min[d] - model.domain_min[d]) / model.cell_size,
                   high = (region.max[d] - model.domain_min[d]) / model.cell_size;
      if (high < first[d] - drift || low > first[d] + B + 1 + drift) return false;  // splines shift a block's cells by one node at most
    }
    return true;
  };
  std::vector<Slots> slots(model.bodies.size());
  for (const Tile& tile : blocks.tiles) {
    const Index<Dim> first = first_node<Dim>(blocks.index[tile.block]);
    if (std::none_of(regions.begin(), regions.end(), [&](const Region& region) { return may_hold(region, first); })) continue;
    for (std::size_t a = tile.begin; a < tile.end; ++a) slots[tile.body].push_back(std::uint32_t(a));
  }
  return slots;
}

namespace {

/// Fields of the particles in some slots, written from place `begin` of a snapshot on.
template <class T, int Dim>
struct SnapshotPart {
  const Model& model;
  const Particles<T, Dim>& particles;
  const std::uint32_t *slot, *end;
  std::size_t begin;

  template <class From, class To>
  void copy(const Array<From>& field, std::vector<To>& into, std::size_t width = 1, std::size_t component = 0) const {
    const From* from = field.data();
    To* to = into.data() + begin * width + component;
    for (const std::uint32_t* a = slot; a != end; ++a, to += width) *to = To(from[*a]);
  }
  void places(std::vector<double>& position) const {
    for (std::size_t d = 0; d < Dim; ++d) {
      copy(particles.position[d], position, Dim, d);
      const double low = model.domain_min[d], h = model.cell_size, N = model.cells[d];
      const bool periodic = model.is_periodic(int(d));
      double* x = position.data() + begin * Dim + d;
      for (const std::uint32_t* a = slot; a != end; ++a, x += Dim) *x = low + (periodic ? *x - N * std::floor(*x / N) : *x) * h;
    }
  }
  void densities(double rho0, std::vector<double>& density) const {
    copy(particles.compression, density);
    for (std::size_t i = begin; i < begin + std::size_t(end - slot); ++i) density[i] = rho0 * (1 + density[i]);
  }
  void material_state(const MaterialKernel<T, Dim>& material, double rho0, const FieldSelection& fields, BodySnapshot& s) const {
    const auto history = std::size_t(material.history_size());
    const int plastic = material.plastic_strain_index();
    double state[16], sigma[6];
    for (std::size_t i = begin; i < begin + std::size_t(end - slot); ++i) {
      const std::size_t a = slot[i - begin];
      const auto e = double(particles.compression[a]);
      for (std::size_t k = 0; k < history; ++k) state[k] = double(particles.history[k][a]);
      if (fields.stress || fields.pressure) material.stress(e, state, sigma);
      if (fields.pressure) s.pressure[i] = -(sigma[0] + sigma[1] + sigma[2]) / 3;
      if (fields.stress) std::copy(sigma, sigma + 6, s.stress.begin() + std::ptrdiff_t(i) * 6);
      if (fields.plastic_strain) s.plastic_strain[i] = plastic < 0 ? 0.0 : state[plastic];
      if (fields.energy) s.strain_energy[i] = material.energy(e, state) * s.mass[i] / (rho0 * (1 + e));
    }
  }
};

}  // namespace

template <class T, int Dim>
void take_body_snapshot(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, const Particles<T, Dim>& p,
                        const FieldSelection& fields, const Slots& slots, BodySnapshot& s) {
  const std::size_t n = slots.size();
  s.id.resize(n), s.position.resize(n * Dim), s.mass.resize(n);
  s.velocity.resize(fields.velocity ? n * Dim : 0);
  s.density.resize(fields.density ? n : 0);
  s.pressure.resize(fields.pressure ? n : 0), s.stress.resize(fields.stress ? n * 6 : 0);
  s.velocity_gradient.assign(fields.velocity_gradient ? n * Dim * Dim : 0, 0.0);
  s.plastic_strain.resize(fields.plastic_strain ? n : 0), s.strain_energy.resize(fields.energy ? n : 0);
  const double rho0 = deck::reference_density(body.material);
  const bool of_material = fields.stress || fields.pressure || fields.energy || fields.plastic_strain;
  for_each_piece("jaxmpm::snapshot", n, [&](std::size_t, std::size_t begin, std::size_t end) {
    const SnapshotPart<T, Dim> part{model, p, slots.data() + begin, slots.data() + end, begin};
    part.copy(p.id, s.id);
    part.places(s.position);
    part.copy(p.mass, s.mass);
    if (fields.density) part.densities(rho0, s.density);
    for (std::size_t d = 0; fields.velocity && d < Dim; ++d) part.copy(p.velocity[d], s.velocity, Dim, d);
    for (std::size_t c = 0; fields.velocity_gradient && c < p.gradient.size(); ++c)
      part.copy(p.gradient[c], s.velocity_gradient, Dim * Dim, c);
    if (of_material) part.material_state(material, rho0, fields, s);
  });
}

template <class T, int Dim>
std::vector<RawArray> save_state(const std::vector<Particles<T, Dim>>& bodies, const std::vector<Tile>& tiles,
                                 const std::vector<std::int64_t>& tile_key, const StepNumbers& numbers) {
  std::vector<RawArray> arrays;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    bodies[b].for_each_field(
        [&](const std::string& name, const auto& field) { arrays.push_back(pack_array(field_name(b, name), field.data(), field.size())); });
  std::vector<std::int64_t> rows;
  for (std::size_t t = 0; t < tiles.size(); ++t)
    rows.insert(rows.end(), {std::int64_t(tiles[t].body), tile_key[t], std::int64_t(tiles[t].begin), std::int64_t(tiles[t].end)});
  arrays.push_back(pack_array("tiles", rows.data(), rows.size()));
  const Dissipation& lost = numbers.dissipation;
  const double values[] = {numbers.drift, numbers.fastest, numbers.last_dt, numbers.time, lost.plastic, lost.viscous, lost.friction};
  arrays.push_back(pack_array("numbers", values, std::size(values)));
  return arrays;
}

template <class T, int Dim>
void restore_state(const std::vector<RawArray>& arrays, std::vector<Particles<T, Dim>>& bodies, std::vector<Tile>& tiles,
                   std::vector<std::int64_t>& tile_key, StepNumbers& numbers, bool may_have_left) {
  std::size_t particles = 0, covered = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (may_have_left) resize(bodies[b], find_array(arrays, field_name(b, "id")).bytes.size() / sizeof(bodies[b].id[0]));
    bodies[b].for_each_field([&](const std::string& name, auto& field) { unpack_array(arrays, field_name(b, name), field); });
    particles += bodies[b].count();
  }
  std::vector<std::int64_t> rows(find_array(arrays, "tiles").bytes.size() / sizeof(std::int64_t));
  unpack_array(arrays, "tiles", rows);
  std::array<double, 7> values{};
  unpack_array(arrays, "numbers", values);
  numbers = {values[0], values[1], values[2], values[3], {values[4], values[5], values[6]}};
  tiles.clear(), tile_key.clear();
  for (std::size_t t = 0; t + 3 < rows.size(); t += 4) {
    const Tile tile{std::uint32_t(rows[t]), 0, std::size_t(rows[t + 2]), std::size_t(rows[t + 3])};
    if (tile.body >= bodies.size() || tile.begin > tile.end || tile.end > bodies[tile.body].count())
      throw IoError("the tiles of the checkpoint do not fit its particles; it is damaged");
    tiles.push_back(tile), tile_key.push_back(rows[t + 1]);
    covered += tile.end - tile.begin;
  }
  if (covered != particles) throw IoError("the tiles of the checkpoint do not cover its particles; it is damaged");
}

template <class T, int Dim>
void release_leavers(const Model& model, Particles<T, Dim>& p, std::size_t begin, std::size_t end) {
  for (std::size_t a = begin; a < end; ++a)
    for (std::size_t d = 0; d < Dim; ++d) {
      double& X = p.position[d][a];
      const double N = model.cells[d];
      const bool low = X < 0 && model.is_open(int(d), false), high = X > N && model.is_open(int(d), true);
      if (!low && !high) continue;
      X = low ? 0 : N, p.mass[a] = T(0);
      for (auto& v : p.velocity) v[a] = T(0);
    }
}

template <class T, int Dim>
void remove_leavers(Particles<T, Dim>& p) {
  const Slots there = all_slots(p, false);
  if (there.size() == p.count()) return;
  p.for_each_field([&](const std::string&, auto& field) {
    for (std::size_t a = 0; !field.empty() && a < there.size(); ++a) field[a] = field[there[a]];
  });
  resize(p, there.size());
}

template <class T, int Dim>
void check_particles(const Model& model, const Body& body, const MaterialKernel<T, Dim>& material, const Particles<T, Dim>& p,
                     std::size_t begin, std::size_t end) {
  for (std::size_t a = begin; a < end; ++a) {
    bool inside = true, finite = std::isfinite(p.compression[a]) && p.compression[a] > T(-1) && p.compression[a] < T(1e6);
    std::ostringstream place;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double X = p.position[d][a];
      inside = inside && (model.is_periodic(int(d)) || (X >= 0 && X <= model.cells[d])),
      finite = finite && std::isfinite(X) && std::isfinite(p.velocity[d][a]);
      place << (d ? ", " : "") << model.domain_min[d] + X * model.cell_size;
    }
    double history[16] = {};
    for (std::size_t k = 0; k < p.history.size(); ++k) history[k] = double(p.history[k][a]), finite = finite && std::isfinite(history[k]);
    finite = finite && std::isfinite(material.wave_speed(double(p.compression[a]), history));
    if (inside && finite) continue;
    std::ostringstream text;
    text << "particle " << p.id[a] << " of body \"" << body.name << "\" at (" << place.str() << ") "
         << (finite ? "has left the domain" : "has a state that is not finite");
    if (model.method.basis == deck::Basis::linear)
      text
          << "; with linear splines what passes a plane of nodes is strained by nodes that have next to no mass, which \"quadratic\" avoids";
    throw NumericsError(text.str());
  }
}

template std::vector<Slots> slots_within(const Model&, const Blocks<2>&, double, const std::vector<Region>&);
template std::vector<Slots> slots_within(const Model&, const Blocks<3>&, double, const std::vector<Region>&);
template Particles<float, 2> first_particles(const Model&, const Body&, const MaterialKernel<float, 2>&, double&);
template double stable_step(const Model&, const MaterialKernels<float, 2>&, double);
template Slots all_slots(const Particles<float, 2>&, bool);
template void take_body_snapshot(const Model&, const Body&, const MaterialKernel<float, 2>&, const Particles<float, 2>&,
                                 const FieldSelection&, const Slots&, BodySnapshot&);
template std::vector<RawArray> save_state(const std::vector<Particles<float, 2>>&, const std::vector<Tile>&,
                                          const std::vector<std::int64_t>&, const StepNumbers&);
template void restore_state(const std::vector<RawArray>&, std::vector<Particles<float, 2>>&, std::vector<Tile>&, std::vector<std::int64_t>&,
                            StepNumbers&, bool);
template void release_leavers(const Model&, Particles<float, 2>&, std::size_t, std::size_t);
template void remove_leavers(Particles<float, 2>&);
template void check_particles(const Model&, const Body&, const MaterialKernel<float, 2>&, const Particles<float, 2>&, std::size_t,
                              std::size_t);
template Particles<float, 3> first_particles(const Model&, const Body&, const MaterialKernel<float, 3>&, double&);
template double stable_step(const Model&, const MaterialKernels<float, 3>&, double);
template Slots all_slots(const Particles<float, 3>&, bool);
template void take_body_snapshot(const Model&, const Body&, const MaterialKernel<float, 3>&, const Particles<float, 3>&,
                                 const FieldSelection&, const Slots&, BodySnapshot&);
template std::vector<RawArray> save_state(const std::vector<Particles<float, 3>>&, const std::vector<Tile>&,
                                          const std::vector<std::int64_t>&, const StepNumbers&);
template void restore_state(const std::vector<RawArray>&, std::vector<Particles<float, 3>>&, std::vector<Tile>&, std::vector<std::int64_t>&,
                            StepNumbers&, bool);
template void release_leavers(const Model&, Particles<float, 3>&, std::size_t, std::size_t);
template void remove_leavers(Particles<float, 3>&);
template void check_particles(const Model&, const Body&, const MaterialKernel<float, 3>&, const Particles<float, 3>&, std::size_t,
                              std::size_t);
template Particles<double, 2> first_particles(const Model&, const Body&, const MaterialKernel<double, 2>&, double&);
template double stable_step(const Model&, const MaterialKernels<double, 2>&, double);
template Slots all_slots(const Particles<double, 2>&, bool);
template void take_body_snapshot(const Model&, const Body&, const MaterialKernel<double, 2>&, const Particles<double, 2>&,
                                 const FieldSelection&, const Slots&, BodySnapshot&);
template std::vector<RawArray> save_state(const std::vector<Particles<double, 2>>&, const std::vector<Tile>&,
                                          const std::vector<std::int64_t>&, const StepNumbers&);
template void restore_state(const std::vector<RawArray>&, std::vector<Particles<double, 2>>&, std::vector<Tile>&,
                            std::vector<std::int64_t>&, StepNumbers&, bool);
template void release_leavers(const Model&, Particles<double, 2>&, std::size_t, std::size_t);
template void remove_leavers(Particles<double, 2>&);
template void check_particles(const Model&, const Body&, const MaterialKernel<double, 2>&, const Particles<double, 2>&, std::size_t,
                              std::size_t);
template Particles<double, 3> first_particles(const Model&, const Body&, const MaterialKernel<double, 3>&, double&);
template double stable_step(const Model&, const MaterialKernels<double, 3>&, double);
template Slots all_slots(const Particles<double, 3>&, bool);
template void take_body_snapshot(const Model&, const Body&, const MaterialKernel<double, 3>&, const Particles<double, 3>&,
                                 const FieldSelection&, const Slots&, BodySnapshot&);
template std::vector<RawArray> save_state(const std::vector<Particles<double, 3>>&, const std::vector<Tile>&,
                                          const std::vector<std::int64_t>&, const StepNumbers&);
template void restore_state(const std::vector<RawArray>&, std::vector<Particles<double, 3>>&, std::vector<Tile>&,
                            std::vector<std::int64_t>&, StepNumbers&, bool);
template void release_leavers(const Model&, Particles<double, 3>&, std::size_t, std::size_t);
template void remove_leavers(Particles<double, 3>&);
template void check_particles(const Model&, const Body&, const MaterialKernel<double, 3>&, const Particles<double, 3>&, std::size_t,
                              std::size_t);

}  // namespace jaxmpm
