// The driver with its files: what they hold, standard errors, refusals, and going on after a kill at any evaluation.
#include "inverse/inversion.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "fake_objective.hpp"
#include "inverse/differentiated_run.hpp"
#include "io/files.hpp"
#include "io/hdf5.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {

const std::string gravity = R"("unknowns": [ { "path": "/gravity/*", "bounds": [-10, 10] } ])";
const std::string lbfgs = R"(, "optimizer": { "method": "lbfgs", "iterations": 40 })";

/// Stops as a signal does, or dies as a kill -9 does, at an evaluation.
class StoppedObjective : public GravityObjective {
 public:
  explicit StoppedObjective(bool kill = false) : kill_(kill) {}
  Evaluation loss(const Values& values) override {
    try {
      return GravityObjective::loss(values);
    } catch (const Interrupted&) {
      if (kill_) throw;
      throw Stopped{};
    }
  }

 private:
  bool kill_;
};

nlohmann::json result(const InversionDirectory& directory) { return nlohmann::json::parse(read_file(directory.json())); }

/// All that an inversion found, without what it took.
nlohmann::json findings(const InversionDirectory& directory) {
  nlohmann::json json = result(directory);
  for (auto& one : json["iterations"]) {
    one.erase("forward_seconds");
    one.erase("gradient_seconds");
  }
  json.erase("gradient_peak_bytes");
  return json;
}

bool invert(const InverseDeck& own, const InversionDirectory& directory, Objective& objective) {
  const Unknowns unknowns(own.deck);
  directory.prepare();
  Inversion inversion(own.deck, unknowns, objective, directory, directory.read(own.deck, unknowns));
  return inversion.run();
}

}  // namespace

TEST_CASE("inversion.json and inversion.h5 hold iterations, unknowns with standard errors, and the initial fields") {
  const InverseDeck own(gravity + lbfgs);
  const InversionDirectory directory(own.folder() + "/out");
  CHECK_FALSE(directory.holds_inversion());
  GravityObjective objective;
  CHECK(invert(own, directory, objective));
  CHECK(directory.holds_inversion());
  const nlohmann::json json = result(directory);
  CHECK(json["stopped"] == "converged");
  REQUIRE(json["iterations"].size() > 5);
  const auto& first = json["iterations"][0];
  CHECK(first["loss"].get<double>() == Approx((0.25 + 1 + 3.5 * 3.5) / 2));
  CHECK(first["unknowns"]["/gravity/1"] == -9);
  CHECK(first["forward_seconds"] == 1);
  CHECK(first["gradient_seconds"] == 2);
  CHECK(json["unknowns"]["/gravity/0"]["value"].get<double>() == Approx(1));
  CHECK(json["unknowns"]["/gravity/1"]["value"].get<double>() == Approx(-8));
  CHECK(json["unknowns"]["/gravity/1"]["standard_error"].get<double>() < 1e-3);
  const hdf5::Reader file(directory.h5());
  CHECK(file.text_attribute("/", "stopped") == "converged");
  CHECK(file.numbers("/history/loss").size() == json["iterations"].size());
  CHECK(file.numbers("/unknowns/gravity/0/history")[0] == 0.5);
  CHECK(file.numbers("/unknowns/gravity/0/value")[0] == json["unknowns"]["/gravity/0"]["value"]);
  CHECK(file.shape("/bodies/pool/velocity") == std::vector<std::size_t>{60, 2});
  CHECK(file.numbers("/bodies/pool/position")[0] == Approx(0.025));
}

TEST_CASE("An inversion that is stopped or killed at every evaluation ends as one that is not") {
  for (const std::string& optimizer : {lbfgs, std::string(R"(, "optimizer": { "method": "adam", "iterations": 25 })"),
                                       std::string(R"(, "optimizer": { "method": "gauss_newton" })")}) {
    const InverseDeck own(gravity + optimizer);
    const InversionDirectory whole(own.folder() + "/whole");
    GravityObjective plain;
    CHECK(invert(own, whole, plain));
    for (const bool kill : {false, true}) {
      const InversionDirectory parts(own.folder() + (kill ? "/killed" : "/stopped"));
      int processes = 0;
      for (bool done = false; !done && processes < 200; ++processes) {
        StoppedObjective objective(kill);
        objective.stop_at = 7;
        try {
          done = invert(own, parts, objective);
          if (!done) CHECK(result(parts)["stopped"] == "stopped");
        } catch (const GravityObjective::Interrupted&) {
          if (parts.holds_inversion()) CHECK(result(parts)["stopped"] == "running");
        }
      }
      CHECK(processes > 2);
      CHECK(findings(parts) == findings(whole));
    }
  }
}

TEST_CASE("Another deck's inversion is not gone on with, but more iterations are") {
  const InverseDeck few(gravity + R"(, "optimizer": { "method": "lbfgs", "iterations": 4 })");
  const InversionDirectory directory(few.folder() + "/out");
  GravityObjective objective;
  CHECK(invert(few, directory, objective));
  CHECK(result(directory)["stopped"] == "iterations");
  const InverseDeck other(R"("unknowns": [ { "path": "/gravity/0" } ], "optimizer": { "method": "lbfgs", "iterations": 4 })");
  CHECK_THROWS_WITH(invert(other, directory, objective), Catch::Contains("/inverse/unknowns/0/path"));
  const InverseDeck more(gravity + lbfgs);
  CHECK(invert(more, directory, objective));
  CHECK(result(directory)["stopped"] == "converged");
}

TEST_CASE("Standard errors are those of linear regression") {
  // y = a + b x at x = −1, 0, 1, 2 with residuals 0.1, −0.2, 0.1, 0: JᵀJ = [4 2; 2 6], Σr² = 0.06, s² = 0.03.
  Linearisation about{0.03, {0, 0}, SquareMatrix(2), 4};
  about.normal.entries = {4, 2, 2, 6};
  const auto errors = standard_errors(about, {1, -10});
  REQUIRE(errors);
  CHECK((*errors)[0] == Approx(std::sqrt(0.03 * 6 / 20)));
  CHECK((*errors)[1] == Approx(10 * std::sqrt(0.03 * 4 / 20)));
  about.residuals = 2;
  CHECK_FALSE(standard_errors(about, {1, 1}));
}

TEST_CASE("The search steps back from what the deck does not allow; too many unknowns are no Gauss-Newton's") {
  const InverseDeck free(
      R"("unknowns": [ { "path": "/walls/y_min/segments/*/coefficient" } ], "optimizer": { "method": "adam", "iterations": 30 })");
  class Falling : public GravityObjective {
   public:
    Evaluation gradient(const Values& values) override {
      with_values(deck, values);  // as a run would
      return {loss(values).loss, {{"/walls/y_min/segments/0/coefficient", {1}}, {"/walls/y_min/segments/1/coefficient", {1}}}};
    }
    Evaluation loss(const Values& values) override {
      Evaluation found;
      for (const auto& [pointer, value] : values) found.loss += 1 + value.at(0);
      return found;
    }
    deck::Deck deck;
  } objective;
  objective.deck = free.deck;
  CHECK(invert(free, InversionDirectory(free.folder() + "/out"), objective));
  const nlohmann::json found = result(InversionDirectory(free.folder() + "/out"))["unknowns"];
  const auto value = [&](const char* k) {
    return found[std::string("/walls/y_min/segments/") + k + "/coefficient"]["value"].get<double>();
  };
  CHECK((value("0") >= 0 && value("0") < 0.01));  // 0 is the least that the deck allows
  CHECK(value("1") >= 0);
  const InverseDeck network(R"("unknowns": [ { "path": "/bodies/0/velocity/0/mlp" } ], "optimizer": { "method": "gauss_newton" })",
                            R"([ { "mlp": { "inputs": ["y"], "hidden": [10, 10] } }, 0 ])");
  CHECK_THROWS_WITH(invert(network, InversionDirectory(network.folder() + "/out"), objective), Catch::Contains("141"));
}

TEST_CASE("Bounds that reach to what the deck does not allow are refused before the search") {
  const auto refusal = [](const std::string& unknown) {
    const InverseDeck own(R"("unknowns": [ )" + unknown + R"( ], "optimizer": { "method": "gauss_newton" })");
    try {
      check_bounds(own.deck, Unknowns(own.deck));
    } catch (const DeckError& error) {
      return error.problems.at(0).pointer;
    }
    return std::string();
  };
  CHECK(refusal(R"({ "path": "/materials/water/density", "bounds": [-1, 2000] })") == "/inverse/unknowns/0/bounds/0");
  CHECK(refusal(R"({ "path": "/walls/y_min/segments/*/coefficient", "bounds": [-0.5, 1] })") == "/inverse/unknowns/0/bounds/0");
  CHECK(refusal(R"({ "path": "/materials/water/density", "bounds": [500, 2000] })").empty());
}

TEST_CASE("Velocities that were found are a file from which a search may start, but not that of its own directory") {
  const InverseDeck own(R"("unknowns": [ { "path": "/bodies/0/velocity/particles" } ], "optimizer": { "method": "adam", "iterations": 3 })",
                        R"({ "particles": { "file": "v.csv" } })");
  std::string table = "id,vx,vy\n";
  for (int id = 0; id < 60; ++id) table += std::to_string(id) + ",0.1,0\n";
  std::ofstream(own.folder() + "/v.csv") << table;
  class Parabola : public GravityObjective {
   public:
    Evaluation loss(const Values&) override { return {}; }
    Evaluation gradient(const Values& values) override {
      return {0, {{"/bodies/0/velocity/particles", values.at("/bodies/0/velocity/particles")}}};
    }
  } objective;
  const InversionDirectory directory(own.folder() + "/out");
  CHECK(invert(own, directory, objective));
  const nlohmann::json json = result(directory);
  CHECK(json["unknowns"]["/bodies/0/velocity/particles"]["value"]["file"] == "velocity_pool.csv");
  CHECK(json["unknowns"]["/bodies/0/velocity/particles"]["standard_error"].is_null());
  CHECK(json["iterations"][0]["unknowns"].empty());
  const deck::Deck again = deck::with_assignments(own.deck, {"/bodies/0/velocity/particles/file=out/velocity_pool.csv"});
  CHECK(hdf5::Reader(directory.h5()).numbers("/unknowns/bodies/0/velocity/particles/value") == Unknowns(again).space().start);
  CHECK_THROWS_WITH(directory.protect_inputs(again, Unknowns(again)), Catch::Contains("choose another directory"));
  directory.protect_inputs(own.deck, Unknowns(own.deck));
  directory.clear(own.deck, Unknowns(own.deck));
  CHECK_FALSE(std::filesystem::exists(own.folder() + "/out/velocity_pool.csv"));
}
