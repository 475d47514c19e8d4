// The stepper's state as others see it: snapshots for output and gauges, arrays for checkpoints.
#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "solvers/explicit_step.hpp"

namespace jaxmpm {
namespace {

template <class Value>
const char* type_name() {
  if constexpr (std::is_same_v<Value, float>) return "f4";
  else if constexpr (std::is_same_v<Value, double>) return "f8";
  else if constexpr (std::is_same_v<Value, std::uint32_t>) return "u4";
  else return "i8";
}

template <class Value>
RawArray pack_array(const std::string& name, const Value* data, std::size_t n) {
  RawArray array{name, type_name<Value>(), {n}, std::vector<unsigned char>(n * sizeof(Value))};
  if (n > 0) std::memcpy(array.bytes.data(), data, array.bytes.size());
  return array;
}

const RawArray& find_array(const std::vector<RawArray>& arrays, const std::string& name) {
  const auto at = std::find_if(arrays.begin(), arrays.end(), [&](const RawArray& a) { return a.name == name; });
  if (at == arrays.end()) throw IoError("the checkpoint has no array \"" + name + "\"; it is of another deck, or damaged");
  return *at;
}

/// Copies an array of a checkpoint to `out`, which has the size that the model asks for.
template <class Container>
void unpack_array(const std::vector<RawArray>& arrays, const std::string& name, Container& out) {
  using Value = typename Container::value_type;
  const RawArray& array = find_array(arrays, name);
  if (array.type != type_name<Value>() || array.bytes.size() != out.size() * sizeof(Value))
    throw IoError("array \"" + name +
                  "\" of the checkpoint has another type or length than this deck's; it is of another deck, or damaged");
  if (!out.empty()) std::memcpy(out.data(), array.bytes.data(), array.bytes.size());
}

std::string field_name(std::size_t body, const std::string& field) { return "body" + std::to_string(body) + "_" + field; }

}  // namespace

template <class T, int Dim>
std::vector<BodySnapshot> ExplicitStep<T, Dim>::snapshot(const FieldSelection& fields, bool ordered) const {
  std::vector<BodySnapshot> out(bodies_.size());
  const double h = model_.cell_size;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Particles<T, Dim>& p = bodies_[b];
    const MaterialKernel<T, Dim>& material = *materials_[b];
    const std::size_t n = p.count(), history = std::size_t(material.history_size());
    std::vector<std::uint32_t> place(n);  // of each storage slot in the snapshot
    std::iota(place.begin(), place.end(), 0u);
    if (ordered && n > 0) {  // ids of a body are consecutive
      const std::uint32_t first = *std::min_element(p.id.begin(), p.id.end());
      for (std::size_t a = 0; a < n; ++a) place[a] = p.id[a] - first;
    }
    BodySnapshot& s = out[b];
    const bool stress = fields.stress || fields.pressure;
    s.id.resize(n), s.position.resize(n * Dim), s.mass.resize(n);
    s.velocity.resize(fields.velocity ? n * Dim : 0);
    s.density.resize(fields.density ? n : 0), s.volume.resize(n);
    s.pressure.resize(fields.pressure ? n : 0), s.stress.resize(fields.stress ? n * 6 : 0);
    s.velocity_gradient.resize(fields.velocity_gradient ? n * Dim * Dim : 0);
    s.plastic_strain.resize(fields.plastic_strain ? n : 0), s.strain_energy.resize(fields.energy ? n : 0);
    const double rho0 = std::visit([](const auto& m) { return m.density; }, model_.bodies[b].material);
    parallel_for_host_static("jaxmpm::snapshot", n, [&](std::size_t a) {
      const std::size_t i = place[a];
      const double e = double(p.compression[a]), mass = double(p.mass[a]), density = rho0 * (1 + e);
      s.id[i] = p.id[a], s.mass[i] = mass, s.volume[i] = mass / density;
      for (std::size_t d = 0; d < Dim; ++d) {
        s.position[i * Dim + d] = model_.domain_min[d] + p.position[d][a] * h;
        if (fields.velocity) s.velocity[i * Dim + d] = double(p.velocity[d][a]);
      }
      if (fields.density) s.density[i] = density;
      if (fields.velocity_gradient)
        for (std::size_t k = 0; k < Dim * Dim; ++k)
          s.velocity_gradient[i * Dim * Dim + k] = p.gradient.empty() ? 0.0 : double(p.gradient[k][a]);
      if (!stress && !fields.energy && !fields.plastic_strain) return;
      double state[16] = {};
      for (std::size_t k = 0; k < history; ++k) state[k] = double(p.history[k][a]);
      if (stress) {
        double sigma[6];
        material.stress(e, state, sigma);
        if (fields.pressure) s.pressure[i] = -(sigma[0] + sigma[1] + sigma[2]) / 3;
        if (fields.stress) std::copy(sigma, sigma + 6, s.stress.begin() + std::ptrdiff_t(i) * 6);
      }
      if (fields.plastic_strain) s.plastic_strain[i] = material.plastic_strain_index() < 0 ? 0.0 : state[material.plastic_strain_index()];
      if (fields.energy) s.strain_energy[i] = material.energy(e, state) * s.volume[i];
    });
  }
  return out;
}

template <class T, int Dim>
std::vector<RawArray> ExplicitStep<T, Dim>::save() const {
  std::vector<RawArray> arrays;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    bodies_[b].for_each_field(
        [&](const std::string& name, const auto& field) { arrays.push_back(pack_array(field_name(b, name), field.data(), field.size())); });
  std::vector<std::int64_t> tiles;  // particles drift after a sort: which tile they belong to is state
  for (std::size_t t = 0; t < blocks_.tiles.size(); ++t) {
    const Tile& tile = blocks_.tiles[t];
    tiles.insert(tiles.end(), {std::int64_t(tile.body), tile_key_[t], std::int64_t(tile.begin), std::int64_t(tile.end)});
  }
  arrays.push_back(pack_array("tiles", tiles.data(), tiles.size()));
  const double numbers[] = {drift_, fastest_, last_dt_, dissipation_.plastic, dissipation_.viscous, dissipation_.friction};
  arrays.push_back(pack_array("numbers", numbers, std::size(numbers)));
  return arrays;
}

template <class T, int Dim>
void ExplicitStep<T, Dim>::restore(const std::vector<RawArray>& arrays) {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    bodies_[b].for_each_field([&](const std::string& name, auto& field) { unpack_array(arrays, field_name(b, name), field); });
  std::vector<std::int64_t> tiles(find_array(arrays, "tiles").bytes.size() / sizeof(std::int64_t));
  unpack_array(arrays, "tiles", tiles);
  std::array<double, 6> numbers{};
  unpack_array(arrays, "numbers", numbers);
  drift_ = numbers[0], fastest_ = numbers[1], last_dt_ = numbers[2], dissipation_ = {numbers[3], numbers[4], numbers[5]};
  blocks_.tiles.clear(), tile_key_.clear();
  std::size_t covered = 0;
  for (std::size_t t = 0; t + 3 < tiles.size(); t += 4) {
    const Tile tile{std::uint32_t(tiles[t]), 0, std::size_t(tiles[t + 2]), std::size_t(tiles[t + 3])};
    if (tile.body >= bodies_.size() || tile.begin > tile.end || tile.end > bodies_[tile.body].count())
      throw IoError("the tiles of the checkpoint do not fit its particles; it is damaged");
    blocks_.tiles.push_back(tile), tile_key_.push_back(tiles[t + 1]);
    covered += tile.end - tile.begin;
  }
  if (covered != particle_count()) throw IoError("the tiles of the checkpoint do not cover its particles; it is damaged");
  rebuild_blocks();
}

template class ExplicitStep<float, 2>;
template class ExplicitStep<float, 3>;
template class ExplicitStep<double, 2>;
template class ExplicitStep<double, 3>;

}  // namespace jaxmpm
