#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "inverse/observed_gauge.hpp"
#include "inverse/observed_table.hpp"
#include "io/results_reader.hpp"
#include "observe/gauges.hpp"
#include "scene/frame.hpp"

namespace jaxmpm {
namespace {

/// Axes that are not up, in order.
std::vector<int> horizontal_axes(const Model& model) {
  std::vector<int> axes;
  for (int a = 0; a < model.dim; ++a)
    if (a != up_axis(model).axis) axes.push_back(a);
  return axes;
}

/// The observed surface as a point of space, for a mask box.
Point surface_point(const Model& model, const deck::Numbers& at, double height) {
  Point x{};
  const std::vector<int> axes = horizontal_axes(model);
  for (std::size_t k = 0; k < axes.size(); ++k) x[axes[k]] = at[k];
  x[up_axis(model).axis] = height;
  return x;
}

void add_row(const deck::ProfileObservation& observed, const ObservationPlace& place, const deck::Numbers& at, ObservedRow row,
             ObservedProfile& profile) {
  const auto* box = std::get_if<deck::Box>(&observed.mask);
  if (box && !in_box(*box, surface_point(place.model, at, row.value[0]).data())) return;
  row.subject = profile.at.size();
  profile.at.push_back(at);
  profile.rows.push_back(std::move(row));
}

ObservedProfile profile_of_table(const deck::ProfileObservation& observed, const ObservationPlace& place) {
  const ObservedTable table(observed, place);
  const Model& model = place.model;
  const Point top = domain_max(model);
  const int up = up_axis(model).axis;
  if (table.has("time") && table.has("height"))
    place.bad_file(0, "a profile is that of one time, so the column time would have no effect; remove it, and say when by the key `time`");
  ObservedProfile profile;
  for (std::size_t r = 0; r < table.size(); ++r) {
    deck::Numbers at;
    for (const int a : horizontal_axes(model)) {
      at.push_back(table.value(r, std::string(1, "xyz"[a])));
      if (at.back() < model.domain_min[a] || at.back() > top[a])
        place.bad_file(table.line(r), number_text(at.back()) + " m is outside of the domain along " + "xyz"[a] + ", " +
                                          number_text(model.domain_min[a]) + " m to " + number_text(top[a]) +
                                          " m; leave the row out, or move it into the deck's coordinates");
    }
    const double height = table.value(r, "height");
    if (height < model.domain_min[up] || height > top[up])
      place.bad_file(table.line(r), number_text(height) + " m is no height within the domain, " + number_text(model.domain_min[up]) +
                                        " m to " + number_text(top[up]) +
                                        " m; heights are coordinates in metres: correct the unit, or enlarge the domain");
    if (table.counts(r))
      add_row(observed, place, at, {observed.time.value_or(place.end), 0, {height}, table.sigma(r), table.line(r)}, profile);
  }
  return profile;
}

/// Volume of one place of a body's seed lattice, m³ (m² in 2D), from the deck of its run.
double lattice_volume(const ResultsReader& results, const std::string& body, int dim, const ObservationPlace& place) {
  const auto deck = nlohmann::ordered_json::parse(results.deck());
  for (const auto& one : deck.at("bodies")) {
    if (one.at("name") != body) continue;
    if (!one.contains("spacing") && !one.contains("particles_per_cell"))
      place.bad_file(
          0, "body '" + body + "' was placed by points of a file there, and its frames do not hold their volumes; give the profile as CSV");
    if (one.contains("spacing") && one.at("spacing").is_number()) return std::pow(one.at("spacing").get<double>(), dim);
    return std::pow(deck.at("domain").at("cell_size").get<double>(), dim) / one.at("particles_per_cell").get<double>();
  }
  throw IoError("'" + results.path() + "' has frames of body '" + body + "', but its deck has no such body; the file is damaged.");
}

/// The frame at a time: frames are taken at the first step at or after theirs.
std::size_t frame_at(const ResultsReader& results, double time, const ObservationPlace& place) {
  const std::vector<double>& times = results.frame_times();
  if (times.empty()) place.bad_file(0, "the run wrote no frames as \"hdf5\"; add it to its /output/formats");
  std::size_t nearest = 0;
  for (std::size_t f = 1; f < times.size(); ++f)
    if (std::abs(times[f] - time) < std::abs(times[nearest] - time)) nearest = f;
  if (std::abs(times[nearest] - time) > 1e-3 * place.end)
    place.bad_file(0, "no frame lies at " + number_text(time) + " s; the nearest is at " + number_text(times[nearest]) +
                          " s: observe it there (key `time`)");
  return nearest;
}

/// What the height gauge needs of the body's particles in a frame.
BodySnapshot particles_of(const ResultsReader& results, std::size_t frame, const deck::ProfileObservation& observed,
                          const ObservationPlace& place) {
  for (const std::size_t f : {std::size_t(0), frame})
    if (!results.has_field(f, observed.body, "density"))
      place.bad_file(
          0, "the frames hold no density of '" + observed.body + "', which the height needs; run again with it among /output/fields");
  const double volume = lattice_volume(results, observed.body, place.model.dim, place);
  BodySnapshot particles;
  particles.position = results.field(frame, observed.body, "position");
  particles.density = results.field(frame, observed.body, "density");
  particles.mass = results.field(0, observed.body, "density");
  for (double& mass : particles.mass) mass *= volume;
  particles.id.resize(particles.mass.size());
  return particles;
}

/// Middles of the cells of the domain's floor.
std::vector<deck::Numbers> floor_cells(const Model& model) {
  std::vector<deck::Numbers> places{{}};
  for (const int a : horizontal_axes(model)) {
    std::vector<deck::Numbers> longer;
    for (const deck::Numbers& place : places)
      for (int i = 0; i < model.cells[a]; ++i) {
        longer.push_back(place);
        longer.back().push_back(model.domain_min[a] + (i + 0.5) * model.cell_size);
      }
    places = std::move(longer);
  }
  return places;
}

ObservedProfile profile_of_results(const deck::ProfileObservation& observed, const ObservationPlace& place, std::size_t body) {
  const ResultsReader results(place.file);
  const double time = observed.time.value_or(place.end);
  const std::size_t frame = frame_at(results, time, place);
  const std::vector<std::string> known = results.bodies(frame);
  if (std::find(known.begin(), known.end(), observed.body) == known.end())
    place.bad_file(0, "the run has no body '" + observed.body + "'; name the body as it is called there, in both decks");
  std::vector<BodySnapshot> bodies(place.model.bodies.size());
  bodies[body] = particles_of(results, frame, observed, place);
  const ContactForces forces;
  const Scene scene{{}, bodies, forces, {}};
  ObservedProfile profile;
  for (const deck::Numbers& at : floor_cells(place.model)) {
    const Sample height = make_deposit_gauge(at, place.model, body, observed.reading)->measure(scene, nullptr);
    add_row(observed, place, at, {std::min(results.frame_times()[frame], place.end), 0, height.values, 1, 0}, profile);
  }
  return profile;
}

}  // namespace

ObservedProfile read_profile(const deck::ProfileObservation& observed, const ObservationPlace& place, std::size_t body) {
  const bool results = is_hdf5(place.file);
  if (results) refuse_mask_column(observed, place);
  ObservedProfile profile = results ? profile_of_results(observed, place, body) : profile_of_table(observed, place);
  if (profile.rows.empty()) place.bad_file(0, "no row is left by the mask; nothing would be observed");
  return profile;
}

}  // namespace jaxmpm
