// From a number of the deck through the first state, the run and its observations to the loss, and back: against central differences.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../deck/example.hpp"
#include "inverse/differentiated_run.hpp"
#include "inverse/observations.hpp"
#include "inverse/scene_gradient.hpp"

using namespace jaxmpm;

namespace {

const char* const slumping = R"deck({
  "jaxmpm": 1,
  "domain": { "min": [0, 0], "max": [1, 0.5], "cell_size": 0.05 },
  "gravity": [0, -9.81], "time": { "end": 0.04, "step": 2e-4 },
  "parameters": { "u": 0.5 },
  "materials": {
    "water": { "model": "newtonian", "density": 1000, "sound_speed": 15, "viscosity": 2 },
    "rubber": { "model": "linear_elastic", "density": 1200, "youngs_modulus": 2e5, "poisson_ratio": 0.3 } },
  "bodies": [
    { "name": "pool", "material": "water", "shape": { "box": { "min": [0, 0], "max": [0.4, 0.3] } }, "initial_stress": "hydrostatic", "velocity": ["u*(1+y)", 0] },
    { "name": "block", "material": "rubber", "shape": { "box": { "min": [0.6, 0], "max": [0.8, 0.2] } }, "initial_stress": { "k0": 0.6 }, "velocity": [-0.3, 0] } ],
  "walls": { "y_min": { "kind": "friction", "coefficient": 0.3 } },
  "gauges": { "front": { "kind": "front", "body": "pool", "axis": "x" }, "level": { "kind": "height", "at": [0.22] }, "probe": { "kind": "pressure", "at": [0.1, 0.1] },
              "mean": { "kind": "region_mean", "field": "velocity", "min": [0.1, 0.1], "max": [0.3, 0.3] } },
  "output": { "interval": 0.05 },
  "inverse": { "unknowns": [ { "path": "/parameters/u" } ], "observations": [
    { "kind": "particles", "body": "pool", "field": "position", "file": "p.csv", "weight": 10 },
    { "kind": "gauge", "gauge": "front", "file": "front.csv" },
    { "kind": "gauge", "gauge": "level", "file": "level.csv" },
    { "kind": "gauge", "gauge": "probe", "file": "probe.csv", "weight": 1e-8 },
    { "kind": "gauge", "gauge": "mean", "file": "mean.csv" },
    { "kind": "profile", "body": "block", "file": "profile.csv" } ] } })deck";

}  // namespace

TEST_CASE("the loss of a deck's observations by numbers of the deck") {
  const test::Folder folder;
  folder.file("p.csv", "time,id,x,y\n0.01,30,0.1,0.1\n0.02,31,0.3,0.2\n0.04,95,0.3,0.1\n");
  folder.file("front.csv", "time,value\n0.01,0.42\n0.03,0.46\n");
  folder.file("level.csv", "time,value\n0.02,0.3\n");
  folder.file("probe.csv", "time,value,sigma\n0.02,2000,2\n0.03,1500,1\n");
  folder.file("mean.csv", "time,value_x,value_y\n0.015,0.3,0.1\n");
  folder.file("profile.csv", "x,height\n0.65,0.21\n0.7,0.2\n0.75,0.15\n");
  const deck::Deck deck = deck::read_deck(folder.file("deck.json", slumping));
  const Model model = build_model(deck);
  const auto observer = make_observer(deck, model);
  const StepSequence steps = record_run(model, Backend::cpu, *observer, {});
  CHECK(steps.dt.size() == 200);
  SnapshotStack snapshots(make_state_memory(Backend::cpu));
  MemoryPlan plan = plan_gradient(model, steps, {std::size_t(1) << 32, 0}, snapshots);
  RunCost cost;
  const ModelGradient gradient = differentiate_run(model, steps, *observer, plan, snapshots, cost, {});
  CHECK(observer->loss() > 0);

  const std::vector<std::string> pointers{"/gravity/1",
                                          "/parameters/u",
                                          "/materials/water/density",
                                          "/materials/water/sound_speed",
                                          "/materials/water/viscosity",
                                          "/materials/rubber/density",
                                          "/materials/rubber/youngs_modulus",
                                          "/materials/rubber/poisson_ratio",
                                          "/bodies/1/initial_stress/k0",
                                          "/bodies/1/velocity/0",
                                          "/walls/y_min/coefficient"};
  const auto exact = gradient_by_pointer(deck, model, gradient, pointers);
  const nlohmann::json resolved = nlohmann::json::parse(deck.resolved);
  for (const std::string& pointer : pointers) {
    const double value = resolved.at(nlohmann::json::json_pointer(pointer)).get<double>();
    const auto loss = [&](double moved) {
      const Model other = build_model(deck::with_assignments(deck, {pointer + "=" + nlohmann::json(moved).dump()}));
      replay_run(other, Backend::cpu, steps, *observer, {});
      return observer->loss();
    };
    const auto slope = [&](double h) { return (loss(value + h) - loss(value - h)) / (2 * h); };
    const double h = 1e-5 * std::abs(value);  // at 1.3e-5 of the sound speed a contact changes
    INFO(pointer);
    CHECK(exact.at(pointer).at(0) == Approx((4 * slope(h / 2) - slope(h)) / 3).epsilon(1e-6));
  }
}
