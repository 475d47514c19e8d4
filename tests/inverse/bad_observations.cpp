// Observations that do not fit the deck or the file: pointer, remedy and exit code.
#include <catch2/catch.hpp>

#include "observed_scene.hpp"

using namespace jaxmpm;
using Catch::Contains;
using test::ObservedScene;

namespace {

struct Refused {
  std::string observation, pointer, message;
};

/// Observations whose file is p.csv with the given text (p.csv stays unwritten when that is empty).
void check_refused(const std::string& text, const std::vector<Refused>& cases) {
  const ObservedScene scene;
  if (!text.empty()) scene.folder.file("p.csv", text);
  for (const Refused& one : cases) {
    INFO(one.observation);
    try {
      const deck::Deck deck = scene.deck(one.observation);
      make_observer(deck, build_model(deck));
      FAIL_CHECK("was accepted");
    } catch (const DeckError& error) {
      CHECK(error.code == ExitCode::deck);
      CHECK(error.problems.at(0).pointer == one.pointer);
      CHECK_THAT(std::string(error.what()), Contains(one.message));
    }
  }
}

std::string particles(const std::string& keys) {
  return R"({"kind": "particles", "body": "pool", "field": "position", "file": "p.csv")" + keys + "}";
}
std::string gauge(const std::string& name, const std::string& keys = "") {
  return R"({"kind": "gauge", "gauge": ")" + name + R"(", "file": "p.csv")" + keys + "}";
}
std::string profile(const std::string& keys) { return R"({"kind": "profile", "body": "pool", "file": "p.csv")" + keys + "}"; }
const std::string here = "/inverse/observations/0";

}  // namespace

TEST_CASE("what the deck alone tells about observations") {
  check_refused("time,value\n0,1\n", {{gauge("hard"), here + "/gauge", "give it a width"},
                                      {gauge("load"), here + "/gauge", "observe a pressure"},
                                      {gauge("energy"), here + "/gauge", "no derivative"},
                                      {gauge("front", R"(, "mask": {"box": {"min": [0, 0], "max": [1, 1]}})"), here + "/mask", "no effect"},
                                      {gauge("front", R"(, "from_time": 0.5)"), here + "/from_time", "after the end of the run"},
                                      {gauge("front", R"(, "to_time": 0.5)"), here + "/to_time", "after the end of the run"},
                                      {profile(R"(, "every": 0.5)"), here + "/every", "no effect"},
                                      {profile(R"(, "from_time": 0.05)"), here + "/from_time", "no effect"},
                                      {profile(R"(, "time": 0.5)"), here + "/time", "after the end of the run"}});
}

TEST_CASE("CSV that does not fit") {
  const std::string file = here + "/file";
  check_refused("time,id,x,y,sigma,good\n0.02,9,1,1,1,1\n0.05,7,1,1,1,0\n",
                {{particles(R"(, "mask": "bad")"), file, "there is no column 'bad'"},
                 {particles(R"(, "select": {"ids": [9, 12]})"), here + "/select/ids/1", "has no particle 12"},
                 {particles(R"(, "select": {"random": 3})"), here + "/select/random", "has 2 of this body"},
                 {particles(R"(, "from_time": 0.06)"), file, "no row lies between 0.06 s and 0.1 s"},
                 {particles(R"(, "select": {"ids": [7]}, "mask": "good")"), file, "no row is left"},
                 {particles(R"(, "mask": {"box": {"min": [0, 0], "max": [0.5, 0.5]}})"), file, "no row is left"},
                 {gauge("front"), file, "there is no column 'value'"},
                 {gauge("some"), here + "/gauge", "observe them as \"particles\""},
                 {profile(""), file, "there is no column 'height'"}});
  check_refused("time,id,x,y\n0.02,60,1,1\n",
                {{particles(""), file, "line 2: 60 is the id of no particle of body 'pool', whose ids are from 0 to 59"}});
  check_refused("time,id,x,y\n0.02,1.5,1,1\n", {{particles(""), file, "line 2"}});
  check_refused("time,id,x,y\n0.02,1,1,1\n0.02,1,2,2\n", {{particles(""), file, "line 3: a second row"}});
  check_refused("time,id,x,y\n-0.02,1,1,1\n", {{particles(""), file, "before the run's start"}});
  check_refused("time,value\n0.05,1\n0.2,1\n", {{gauge("front"), file, "line 3: the time 0.2 s is after the run's end at 0.1 s"}});
  check_refused("time,id,x,y,sigma\n0.02,1,1,1,0\n", {{particles(""), file, "line 2: sigma"}});
  check_refused("time,id,x,y,good\n0.02,1,1,1,2\n", {{particles(R"(, "mask": "good")"), file, "line 2: the mask column"}});
  check_refused("time,value\n0.2,1\n", {{gauge("front"), file, "all rows (0.2 s to 0.2 s) lie after 0.1 s"}});
  check_refused("x,height\n1.5,0\n", {{profile(""), file, "line 2: 1.5 m is outside of the domain along x, 0 m to 1 m"}});
}

TEST_CASE("a file that cannot be read is an input error") {
  const ObservedScene scene;
  for (const std::string& observation : {particles(""), gauge("front"), profile("")}) {
    const deck::Deck deck = scene.deck(observation);
    CHECK_THROWS_AS(make_observer(deck, build_model(deck)), IoError);
    CHECK_THROWS_WITH(make_observer(deck, build_model(deck)), Contains("/inverse/observations/0/file: cannot read"));
  }
}

TEST_CASE("results that do not fit") {
  const ObservedScene scene;
  const auto refused = [&](std::string observation, const std::string& pointer, const std::string& message) {
    observation.replace(observation.find("p.csv"), 5, "truth/results.h5");
    const deck::Deck deck = scene.deck(observation);
    try {
      make_observer(deck, build_model(deck));
      FAIL_CHECK("was accepted");
    } catch (const DeckError& error) {
      CHECK(error.problems.at(0).pointer == pointer);
      CHECK_THAT(std::string(error.what()), Contains(message));
    }
  };
  const deck::Deck deck = scene.deck(particles(""));
  const Model model = build_model(deck);
  std::vector<std::vector<BodySnapshot>> frames{test::moved(model, 1)};
  const std::string directory = scene.folder.directory("truth"), file = here + "/file";
  test::write_results(directory, deck, frames, {}, {});
  refused(R"({"kind": "particles", "body": "pool", "field": "velocity", "file": "p.csv"})", file, "hold no velocity of 'pool'");
  refused(particles(R"(, "mask": "good")"), here + "/mask", "use a box");
  refused(gauge("front"), file, "has no gauge 'front'");
  refused(profile(""), file, "no frame lies at 0.1 s; the nearest is at 0 s");
  refused(profile(R"(, "time": 0)"), file, "hold no density");
  for (double& x : frames[0][0].position) x += 0.06;
  test::write_results(directory, deck, frames);
  refused(particles(""), file, "seeded otherwise");
  test::write_results(directory, deck, {});
  refused(particles(""), file, "wrote no frames");
}
