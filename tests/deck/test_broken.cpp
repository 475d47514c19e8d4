// Every broken deck of tests/broken is refused at the right place and for the right reason, with at most one problem beside it.
// than its own.
#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <set>
#include <sstream>

#include "example.hpp"

namespace {

struct Case {
  std::string file, stage, exit_code, pointer, message;
};

const std::string folder = std::string(JAXMPM_SOURCE_DIR) + "/tests/broken/";

std::vector<Case> cases() {
  std::ifstream table(folder + "expected.csv");
  std::vector<Case> list;
  std::string line;
  std::getline(table, line);
  REQUIRE(line == "file,stage,exit_code,pointer,message");
  const auto plain = [](std::string cell) {  // CSV quotes
    if (cell.size() < 2 || cell[0] != '"') return cell;
    cell = cell.substr(1, cell.size() - 2);
    for (std::size_t at = 0; (at = cell.find("\"\"", at)) != std::string::npos; ++at) cell.erase(at, 1);
    return cell;
  };
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    Case one;
    for (std::string* cell : {&one.file, &one.stage, &one.exit_code, &one.pointer}) std::getline(cells, *cell, ',');
    std::getline(cells, one.message);
    one.message = plain(one.message);
    list.push_back(one);
  }
  return list;
}

}  // namespace

TEST_CASE("broken decks are refused by the reader, with pointer, line and remedy") {
  std::size_t count = 0;
  for (const Case& one : cases()) {
    INFO(one.file << ": " << one.pointer << ": " << one.message);
    if (one.stage != "deck") continue;
    ++count;
    try {
      jaxmpm::deck::read_deck(folder + one.file);
      FAIL_CHECK("was accepted");
    } catch (const jaxmpm::DeckError& error) {
      INFO(error.what());
      CHECK(one.exit_code == std::to_string(static_cast<int>(error.code)));
      const auto found = std::find_if(error.problems.begin(), error.problems.end(), [&one](const jaxmpm::Problem& p) {
        return p.pointer == one.pointer && p.message.find(one.message) != std::string::npos;
      });
      CHECK(found != error.problems.end());
      CHECK(std::all_of(error.problems.begin(), error.problems.end(), [](const auto& p) { return p.line > 0; }));
      CHECK(error.problems.size() <= 2);
    }
  }
  CHECK(count >= 70);
  WARN(count << " broken decks refused");
}

TEST_CASE("what only the scene or the run can find is accepted by the reader") {
  for (const Case& one : cases()) {
    INFO(one.file);
    if (one.stage != "deck") CHECK_NOTHROW(jaxmpm::deck::read_deck(folder + one.file));
  }
}

TEST_CASE("every broken deck is in the table, once") {
  std::multiset<std::string> listed;
  for (const Case& one : cases()) listed.insert(one.file);
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") CHECK(listed.count(entry.path().filename().string()) == 1);
}

TEST_CASE("all problems of a deck are reported at once, in order of lines") {
  const jaxmpm::test::Folder here;
  const std::string path = here.file("many.json", R"({
  "jaxmpm": 1,
  "titel": "x",
  "domain": { "min": [0, 0], "max": [1, 0.5],
              "cell_size": 0.3,
              "cell_size": 0.1 },
  "gravity": [0, 0, -9.81],
  "time": { "end": 1, "step": 1e-5,
            "cfl": 0.4 },
  "materials": { "water": { "model": "newtonian", "sound_speed": "fast" } },
  "bodies": [ { "name": "a", "material": "sand", "particles_per_cell": 5 } ],
  "output": { "interval": 0.1 }
}
)");
  try {
    jaxmpm::deck::read_deck(path);
    FAIL("was accepted");
  } catch (const jaxmpm::DeckError& error) {
    std::set<std::string> places;
    for (const auto& p : error.problems) places.insert(std::to_string(p.line) + " " + p.pointer);
    CHECK(places == std::set<std::string>{"3 /titel", "6 /domain/cell_size", "7 /gravity", "9 /time/cfl", "10 /materials/water/density",
                                          "10 /materials/water/sound_speed", "11 /bodies/0/material", "11 /bodies/0/particles_per_cell",
                                          "11 /bodies/0/shape"});
    CHECK(std::is_sorted(error.problems.begin(), error.problems.end(), [](const auto& a, const auto& b) { return a.line < b.line; }));
  }
}

TEST_CASE("an unreadable deck is an input error") {
  CHECK_THROWS_AS(jaxmpm::deck::read_deck(folder + "nowhere.json"), jaxmpm::IoError);
  CHECK_THROWS_AS(jaxmpm::deck::read_deck(folder), jaxmpm::IoError);
}
