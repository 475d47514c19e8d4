#include "inverse/observed_particles.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "fields/random.hpp"
#include "inverse/observed_table.hpp"
#include "io/results_reader.hpp"
#include "scene/frame.hpp"

namespace jaxmpm {
namespace {

using Ids = std::vector<std::uint64_t>;  // sorted

bool holds(const Ids& ids, std::uint64_t id) { return std::binary_search(ids.begin(), ids.end(), id); }

/// A random choice that depends on the seed and the ids alone: those with the smallest draws of a stream of their own.
Ids draw(const Ids& ids, const deck::RandomSelection& wanted, const ObservationPlace& place) {
  const auto count = static_cast<std::size_t>(wanted.random);
  if (count > ids.size())
    throw DeckError(place.pointer + "/select/random", "asks for " + std::to_string(count) + " particles, '" + place.file + "' has " +
                                                          std::to_string(ids.size()) + " of this body; ask for fewer, or for \"all\"");
  std::vector<std::pair<std::uint64_t, std::uint64_t>> draws;
  for (const std::uint64_t id : ids) draws.emplace_back(RandomStream(wanted.seed, id).next(), id);
  std::sort(draws.begin(), draws.end());
  Ids chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(draws[k].second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// The particles that count, of those that the file has.
Ids choose(Ids ids, const deck::Selection& select, const ObservationPlace& place) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  if (const auto* random = std::get_if<deck::RandomSelection>(&select)) return draw(ids, *random, place);
  const auto* listed = std::get_if<deck::IdSelection>(&select);
  if (listed == nullptr) return ids;
  for (std::size_t i = 0; i < listed->ids.size(); ++i)
    if (!holds(ids, static_cast<std::uint64_t>(listed->ids[i])))
      throw DeckError(place.pointer + "/select/ids/" + std::to_string(i),
                      "'" + place.file + "' has no particle " + std::to_string(listed->ids[i]) + " of this body; its ids are from " +
                          std::to_string(ids.front()) + " to " + std::to_string(ids.back()));
  Ids chosen(listed->ids.begin(), listed->ids.end());
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// The deck's particles of one body: ids are consecutive.
struct OwnParticles {
  const BodyState& state;
  const std::string& name;

  /// Place of the particle with an id in its body.
  std::size_t place(double id, int line, const ObservationPlace& where) const {
    const double place = id - state.id.front();
    if (!(place >= 0 && place < static_cast<double>(state.id.size()) && place == std::floor(place)))
      where.bad_file(line, number_text(id) + " is the id of no particle of body '" + name + "', whose ids are from " +
                               std::to_string(state.id.front()) + " to " + std::to_string(state.id.back()) +
                               "; `jaxmpm check` prints how many there are");
    return static_cast<std::size_t>(place);
  }
};

std::size_t index_of(std::uint64_t id, const Ids& ids) {
  return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

class ResultsParticles {
 public:
  ResultsParticles(const deck::ParticlesObservation& observed, const ObservationPlace& place, std::size_t body)
      : observed_(observed), place_(place), own_{place.model.bodies[body].initial, observed.body}, results_(place.file) {
    if (results_.frame_times().empty()) place.bad_file(0, "the run wrote no frames as \"hdf5\"; add it to its /output/formats");
    check_body();
    chosen_ = choose(results_.ids(0, observed.body), observed.select, place);
    for (const std::uint64_t id : chosen_) subject_.push_back(own_.place(static_cast<double>(id), 0, place));
    if (results_.frame_times()[0] == 0) check_seeding();
  }
  std::vector<ObservedRow> rows() const {
    std::vector<ObservedRow> rows;
    for (std::size_t frame = 0; frame < results_.frame_times().size(); ++frame) add(frame, rows);
    return rows;
  }

 private:
  void check_body() const {
    const std::vector<std::string> bodies = results_.bodies(0);
    std::string known;
    for (const std::string& name : bodies) known += (known.empty() ? "" : ", ") + name;
    if (std::find(bodies.begin(), bodies.end(), observed_.body) == bodies.end())
      place_.bad_file(0, "the run has no body '" + observed_.body + "'; its bodies are " + known);
    if (!results_.has_field(0, observed_.body, observed_.field))
      place_.bad_file(0, "the frames hold no " + observed_.field + " of '" + observed_.body + "'; run again with it among /output/fields");
  }
  /// Equal ids mean equal particles only where both runs were seeded alike.
  void check_seeding() const {
    const Model& model = place_.model;
    const std::vector<double> positions = results_.field(0, observed_.body, "position");
    const Ids ids = results_.ids(0, observed_.body);
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const double* x = &positions[index_of(chosen_[k], ids) * model.dim];
      for (int a = 0; a < model.dim; ++a)
        if (const double own = model.domain_min[a] + own_.state.position[subject_[k]][a] * model.cell_size;
            !(std::abs(x[a] - own) < 0.5 * model.cell_size))
          place_.bad_file(0,
                          "particle " + std::to_string(chosen_[k]) + " starts at " + number_text(x[a]) + " m along " + "xyz"[a] +
                              ", in this deck at " + number_text(own) +
                              " m: the run was seeded otherwise, so its ids are other particles; observe a gauge or the profile instead");
    }
  }
  void add(std::size_t frame, std::vector<ObservedRow>& rows) const {
    const int dim = place_.model.dim;
    const Ids ids = results_.ids(frame, observed_.body);
    const std::vector<double> values = results_.field(frame, observed_.body, observed_.field);
    const auto* box = std::get_if<deck::Box>(&observed_.mask);
    const std::vector<double> positions = box ? results_.field(frame, observed_.body, "position") : std::vector<double>{};
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const std::size_t p = index_of(chosen_[k], ids) * dim;
      if (box && !in_box(*box, &positions[p])) continue;
      rows.push_back({results_.frame_times()[frame],
                      subject_[k],
                      {values.begin() + static_cast<std::ptrdiff_t>(p), values.begin() + static_cast<std::ptrdiff_t>(p) + dim},
                      1,
                      0});
    }
  }

  const deck::ParticlesObservation& observed_;
  const ObservationPlace& place_;
  OwnParticles own_;
  ResultsReader results_;
  Ids chosen_;
  std::vector<std::size_t> subject_;  // of each chosen particle
};

std::vector<ObservedRow> rows_of_table(const deck::ParticlesObservation& observed, const ObservationPlace& place, std::size_t body) {
  const int dim = place.model.dim;
  const ObservedTable table(observed, place);
  const OwnParticles own{place.model.bodies[body].initial, observed.body};
  const std::vector<std::string> axes{"x", "y", "z"}, position(axes.begin(), axes.begin() + dim);
  std::vector<std::string> names = position;
  if (observed.field == "velocity")
    for (std::string& name : names) name = "v" + name;
  Ids ids;
  for (std::size_t r = 0; r < table.size(); ++r) {
    own.place(table.value(r, "id"), table.line(r), place);
    ids.push_back(static_cast<std::uint64_t>(table.value(r, "id")));
  }
  const Ids chosen = choose(ids, observed.select, place);
  const auto* box = std::get_if<deck::Box>(&observed.mask);
  std::vector<ObservedRow> rows;
  for (std::size_t r = 0; r < table.size(); ++r)
    if (holds(chosen, ids[r]) && table.counts(r) && (!box || in_box(*box, table.values(r, position).data())))
      rows.push_back({table.value(r, "time"), static_cast<std::size_t>(ids[r] - own.state.id.front()), table.values(r, names),
                      table.sigma(r), table.line(r)});
  return rows;
}

}  // namespace

std::vector<ObservedRow> read_particles(const deck::ParticlesObservation& observed, const ObservationPlace& place, std::size_t body) {
  if (!is_hdf5(place.file)) return rows_of_table(observed, place, body);
  refuse_mask_column(observed, place);
  return ResultsParticles(observed, place, body).rows();
}

}  // namespace jaxmpm
