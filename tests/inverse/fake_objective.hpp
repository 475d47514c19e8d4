#pragma once
// A deck with unknowns, and an objective that computes a formula of their values in place of a run.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.hpp"
#include "inverse/objective.hpp"

namespace jaxmpm::testing {

/// A deck whose /inverse is `inverse`, in a folder that goes away.
class InverseDeck {
 public:
  explicit InverseDeck(const std::string& inverse, const std::string& velocity = "[0, 0]") {
    std::string name = (std::filesystem::temp_directory_path() / "jaxmpm_inverse_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    std::ofstream(folder_ / "deck.json") << R"({ "jaxmpm": 1, "domain": { "min": [0, 0], "max": [1, 0.5], "cell_size": 0.1 },
      "gravity": [0.5, -9], "time": { "end": 0.1, "step": 1e-3 },
      "materials": { "water": { "model": "newtonian", "density": 1000, "sound_speed": 20 } },
      "bodies": [ { "name": "pool", "material": "water", "shape": { "box": { "min": [0, 0], "max": [0.5, 0.3] } }, "velocity": )" +
                                                velocity + R"( } ],
      "walls": { "y_min": { "kind": "friction", "segments": [ { "to": 0.5, "coefficient": 0.25 }, { "to": 1, "coefficient": 0.75 } ] } },
      "output": { "interval": 0.05 },
      "inverse": { "observations": [ { "kind": "profile", "body": "pool", "file": "p.csv" } ], )" +
                                                inverse + " } }";
    deck = deck::read_deck((folder_ / "deck.json").string());
  }
  ~InverseDeck() { std::filesystem::remove_all(folder_); }
  InverseDeck(const InverseDeck&) = delete;
  InverseDeck& operator=(const InverseDeck&) = delete;
  std::string folder() const { return folder_.string(); }

  deck::Deck deck;

 private:
  std::filesystem::path folder_;
};

/// Residuals of the components x, y of gravity: x − 1, y + 8, x y + 8; so the loss is 0 at (1, −8). Beyond |x| = 5 the run is unstable.
class GravityObjective : public Objective {
 public:
  Evaluation loss(const Values& values) override {
    ++evaluations;
    if (stop_at > 0 && evaluations >= stop_at) throw Interrupted{};
    const double x = values.at("/gravity/0").at(0), y = values.at("/gravity/1").at(0);
    if (x > 5 || x < -5) throw NumericsError("particle 7 left the domain");
    residuals_ = {x - 1, y + 8, x * y + 8};
    Evaluation found;
    for (const double r : residuals_) found.loss += r * r / 2;
    found.forward_seconds = 1;
    return found;
  }
  Evaluation gradient(const Values& values) override {
    Evaluation found = loss(values);
    const double x = values.at("/gravity/0").at(0), y = values.at("/gravity/1").at(0);
    found.gradient["/gravity/0"] = {residuals_[0] + y * residuals_[2]};
    found.gradient["/gravity/1"] = {residuals_[1] + x * residuals_[2]};
    found.gradient_seconds = 2;
    found.peak_bytes = 1000;
    found.particle_steps = 1000;
    return found;
  }
  const std::vector<double>& residuals() const override { return residuals_; }
  void renew_steps(const Values&) override { ++renewals; }
  bool steps_vary() const override { return false; }
  bool admits(const Values&) const override { return true; }

  struct Interrupted {};
  int evaluations = 0, renewals = 0, stop_at = 0;

 private:
  std::vector<double> residuals_;
};

}  // namespace jaxmpm::testing
