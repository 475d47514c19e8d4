#pragma once
// A small pool, with snapshots that a run of it could have given, for the tests of observations.
#include "../deck/example.hpp"
#include "fields/random.hpp"
#include "inverse/observations.hpp"
#include "io/frame.hpp"
#include "io/index.hpp"
#include "io/results_directory.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm::test {

/// The small deck with gauges, its files in a folder of its own.
class ObservedScene {
 public:
  explicit ObservedScene(const std::string& deck_text = small_deck) : path_(folder.file("deck.json", deck_text)) {}
  /// The deck with these observations (JSON, without the brackets of the list).
  deck::Deck deck(const std::string& observations) const {
    return deck::read_deck(path_, {R"(/gauges={"front": {"kind": "front", "body": "pool", "axis": "x"},
        "hard": {"kind": "front", "body": "pool", "axis": "x", "smooth": 0}, "level": {"kind": "height", "at": [0.22]},
        "mean": {"kind": "region_mean", "field": "velocity", "min": [0.1, 0.1], "max": [0.3, 0.3]},
        "far": {"kind": "region_mean", "field": "pressure", "min": [0.8, 0.3], "max": [0.9, 0.4]},
        "some": {"kind": "particles", "ids": [3], "fields": ["position", "stress"]},
        "load": {"kind": "force", "wall": "x_max"}, "energy": {"kind": "energy"}})",
                                   R"(/inverse={"unknowns": [{"path": "/gravity/1"}], "observations": [)" + observations + "]}"});
  }
  Folder folder;

 private:
  std::string path_;
};

/// What a run could show: the first state, moved at random.
inline std::vector<BodySnapshot> moved(const Model& model, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<BodySnapshot> bodies;
  for (const Body& body : model.bodies) {
    BodySnapshot s;
    s.id = body.initial.id;
    for (std::size_t p = 0; p < s.id.size(); ++p) {
      for (int a = 0; a < model.dim; ++a) {
        s.position.push_back(model.domain_min[a] + (body.initial.position[p][a] + 0.2 * random.uniform() - 0.1) * model.cell_size);
        s.velocity.push_back(random.normal());
      }
      s.mass.push_back(body.initial.mass[p] * (0.9 + 0.2 * random.uniform()));
      s.density.push_back(1000 * (0.9 + 0.2 * random.uniform()));
      for (int k = 0; k < 6; ++k) s.stress.push_back(100 * random.normal());
      s.pressure.push_back(-(s.stress[6 * p] + s.stress[6 * p + 1] + s.stress[6 * p + 2]) / 3);
    }
    bodies.push_back(std::move(s));
  }
  return bodies;
}

/// Shows an observer a run; returns its loss.
inline double show(Observer& observer, const std::vector<std::vector<BodySnapshot>>& run) {
  for (std::size_t t = 0; t < observer.times().size(); ++t) observer.look(t, {t, observer.times()[t], 1e-3, 0}, run.at(t));
  return observer.loss();
}

/// A results.h5 with these frames, at 0, 0.02, 0.04 … s.
inline std::string write_results(const std::string& directory, const deck::Deck& deck, const std::vector<std::vector<BodySnapshot>>& frames,
                                 const std::map<std::string, GaugeSeries>& gauges = {},
                                 const std::vector<std::string>& fields = {"velocity", "density"}) {
  const ResultsDirectory results(directory);
  results.prepare({"hdf5"});
  std::vector<FrameEntry> entries;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double time = 0.02 * static_cast<double>(f);
    write_frame(results.frame(f), {f, time, 0.02, 0}, {{"pool", fields}}, frames[f], deck.dimension());
    entries.push_back({f, time});
  }
  write_index(results, deck, "cpu", entries, gauges);
  return results.index();
}

}  // namespace jaxmpm::test
