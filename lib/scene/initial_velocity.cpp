#include "scene/initial_velocity.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "fields/field.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

void set_component(const Field& field, int axis, const Frame& frame, const std::string& pointer, BodyState& state) {
  for (std::size_t p = 0; p < state.position.size(); ++p) {
    const double v = field.value(frame.metres(state.position[p]));
    if (!std::isfinite(v))
      throw DeckError(pointer, "the velocity at " + frame.text(state.position[p]) +
                                   " is not a finite number; make the expression hold over the whole body");
    state.velocity[p][axis] = v;
  }
}

void set_from_components(const std::vector<deck::Component>& components, const deck::Deck& deck, const Frame& frame,
                         const std::string& pointer, BodyState& state) {
  if (components.empty()) return;  // at rest
  if (static_cast<int>(components.size()) != frame.dim)
    throw DeckError(pointer, "give one component for each of the " + std::to_string(frame.dim) + " axes");
  for (int d = 0; d < frame.dim; ++d) {
    const std::string place = pointer + "/" + std::to_string(d);
    set_component(*make_field(components[d], frame.dim, deck.parameters, place), d, frame, place, state);
  }
}

void check_one_time(const Table& table) {
  if (!table.has("time")) return;
  const std::size_t time = table.column("time");
  for (std::size_t r = 1; r < table.rows.size(); ++r)
    if (table.rows[r][time] != table.rows[0][time])
      bad_file(table.pointer, table.file, table.lines[r], "a second time; initial velocities are those of one time, keep its rows only");
}

/// Index of the particle with an id (ids of a body are consecutive), −1 where it is of another body.
std::int64_t particle_of(double id, const BodyState& state) {
  const double index = id - state.id.front();
  return index >= 0 && index < static_cast<double>(state.id.size()) && index == std::floor(index) ? static_cast<std::int64_t>(index) : -1;
}

void set_from_file(const deck::ParticleFile& file, const Frame& frame, const std::string& pointer, BodyState& state) {
  const Table table = read_table(frame.file(file.file), pointer);
  check_one_time(table);
  const std::size_t id = table.column("id");
  std::array<std::size_t, 3> columns{table.column("vx"), table.column("vy"), frame.dim == 3 ? table.column("vz") : 0};
  std::vector<bool> seen(state.id.size(), false);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::int64_t p = particle_of(table.rows[r][id], state);
    if (p < 0) continue;
    if (seen[p]) bad_file(pointer, table.file, table.lines[r], "particle " + std::to_string(state.id[p]) + " is given twice");
    seen[p] = true;
    for (int d = 0; d < frame.dim; ++d) state.velocity[p][d] = table.rows[r][columns[d]];
  }
  const auto missing = std::find(seen.begin(), seen.end(), false);
  if (missing != seen.end())
    bad_file(pointer, table.file, 0,
             "there is no row for particle " + std::to_string(state.id[missing - seen.begin()]) + "; the body's ids run from " +
                 std::to_string(state.id.front()) + " to " + std::to_string(state.id.back()));
}

}  // namespace

void set_initial_velocity(const deck::Deck& deck, const Frame& frame, std::size_t index, BodyState& state) {
  const std::string pointer = "/bodies/" + std::to_string(index) + "/velocity";
  const deck::Velocity& velocity = deck.bodies[index].velocity;
  if (const auto* file = std::get_if<deck::ParticleFile>(&velocity)) set_from_file(*file, frame, pointer + "/particles/file", state);
  else set_from_components(std::get<std::vector<deck::Component>>(velocity), deck, frame, pointer, state);
}

}  // namespace jaxmpm
