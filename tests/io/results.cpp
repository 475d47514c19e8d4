// A whole results directory: frames, index, gauges, VTK, checkpoints, and resuming from them.
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "ballistic.hpp"
#include "io/files.hpp"
#include "io/hdf5.hpp"
#include "io/recorder.hpp"
#include "scratch.hpp"

using namespace jaxmpm;
using testing::Ballistic;
using testing::Scratch;
namespace fs = std::filesystem;

namespace {

deck::Deck ballistic_deck() {
  deck::Deck deck;
  deck.title = "stones";
  deck.time = {0.3, std::nullopt, 0.4};
  deck.output.interval = 0.05;
  deck.output.gauge_interval = 0.01;
  deck.output.fields = {"velocity", "pressure"};
  deck.as_given = "{ /* given */ }";
  deck.resolved = R"({"time": {"end": 0.3}, "gravity": [0, -10], "output": {"interval": 0.05}})";
  deck.gauges["momentum"] = deck::MomentumGauge{};
  deck.gauges["energy"] = deck::EnergyGauge{};
  deck.gauges["stones"] = deck::ParticlesGauge{{3, 1}, {"position", "pressure"}};
  return deck;
}

/// Runs into a directory until `stop_after` steps; resumes what lies there when asked to.
bool run(const std::string& path, int stop_after, bool resume) {
  const deck::Deck deck = ballistic_deck();
  const Model model = testing::ballistic_model();
  const ResultsDirectory directory(path);
  Ballistic solver(model);
  ResultsRecorder recorder(directory, deck, model, solver, "cpu", true);
  RunSettings settings;
  settings.frame_interval = deck.output.interval;
  settings.gauge_interval = *deck.output.gauge_interval;
  settings.stop_requested = [&] { return solver.steps >= stop_after; };
  directory.prepare(deck.output.formats);
  RunStart start;
  const auto from = resume ? newest_checkpoint(directory) : std::nullopt;
  if (from) {
    solver.restore(*from->state);
    recorder.resume(*from);
    start = {from->at, true, from->seconds};
  }
  recorder.begin();
  const bool finished = Simulation(deck.time, settings, solver, recorder).run(start).finished;
  recorder.finish();
  return finished;
}

bool same_bytes(const std::string& a, const std::string& b) { return read_file(a) == read_file(b); }

/// Whether a file is refused or, where the damage hit a byte that means nothing, read as it was.
bool damage_is_harmless(const std::string& path, const Checkpoint& whole) {
  try {
    const Checkpoint read = read_checkpoint(path);
    bool same = read.deck == whole.deck && read.at.step == whole.at.step && read.at.time == whole.at.time &&
                read.state->size() == whole.state->size();
    for (std::size_t k = 0; same && k < whole.state->size(); ++k)
      same = (*read.state)[k].name == (*whole.state)[k].name && (*read.state)[k].bytes == (*whole.state)[k].bytes;
    return same;
  } catch (const IoError&) {
    return true;
  }
}

constexpr int never = 1 << 30;

}  // namespace

TEST_CASE("results hold frames, gauges and what the run was") {
  const Scratch scratch;
  const std::string path = scratch / "out";
  REQUIRE(run(path, never, false));
  const hdf5::Reader index(path + "/results.h5");
  CHECK(index.text_attribute("/", "deck") == "{ /* given */ }");
  CHECK(index.text_attribute("/", "backend") == "cpu");
  CHECK(index.text_attribute("/", "precision") == "f64");
  CHECK(index.names("/frames").size() == 7);
  CHECK(index.shape("/frames/000002/stone/position") == std::vector<std::size_t>{5, 2});  // through the external link
  CHECK(index.names("/frames/000002/stone") == std::vector<std::string>{"id", "position", "pressure", "velocity"});
  const hdf5::Reader frame(path + "/frames/000002.h5");
  const double time = frame.number_attribute("/", "time");
  CHECK(time >= 0.1 - 1e-12);
  CHECK(time < 0.1 + 0.02);
  CHECK(frame.text_attribute("/stone/velocity", "units") == "m/s");
  const std::size_t readings = index.numbers("/gauges/energy/time").size();
  CHECK(index.shape("/gauges/energy/value") == std::vector<std::size_t>{readings, 7});
  CHECK(index.shape("/gauges/stones/position") == std::vector<std::size_t>{readings, 2, 2});
  CHECK(index.shape("/gauges/stones/pressure") == std::vector<std::size_t>{readings, 2});
  const std::vector<double> momentum = index.numbers("/gauges/momentum/value");
  CHECK(momentum[0] == Approx(15));
  CHECK(momentum.back() == Approx(-10 * 5 * 0.3));
}

TEST_CASE("an interrupted and resumed run leaves the files of an uninterrupted one", "[resume]") {
  const Scratch scratch;
  REQUIRE(run(scratch / "whole", never, false));
  for (const int stop_after : {1, 9, 33}) {
    const std::string path = scratch / ("stopped" + std::to_string(stop_after));
    REQUIRE_FALSE(run(path, stop_after, false));
    write_file(path + "/frames/000006.h5", "written after the checkpoint by a run that was then killed");
    REQUIRE(run(path, never, true));
    for (int n = 0; n < 7; ++n)
      for (const std::string field : {"id", "position", "velocity", "pressure"})
        CHECK(hdf5::Reader(scratch / ("whole/frames/" + frame_name(n) + ".h5")).numbers("/stone/" + field) ==
              hdf5::Reader(path + "/frames/" + frame_name(n) + ".h5").numbers("/stone/" + field));
    for (int n = 0; n < 7; ++n)
      CHECK(same_bytes(scratch / ("whole/vtk/" + frame_name(n) + ".vtp"), path + "/vtk/" + frame_name(n) + ".vtp"));
    CHECK(same_bytes(scratch / "whole/vtk/results.pvd", path + "/vtk/results.pvd"));
    const hdf5::Reader whole(scratch / "whole/results.h5"), resumed(path + "/results.h5");
    CHECK(whole.names("/frames") == resumed.names("/frames"));
    for (const std::string set : {"energy/value", "energy/time", "energy/valid", "momentum/value", "stones/position"})
      CHECK(whole.numbers("/gauges/" + set) == resumed.numbers("/gauges/" + set));
  }
}

TEST_CASE("a damaged checkpoint is noticed, and the one before it taken", "[resume]") {
  const Scratch scratch;
  const ResultsDirectory directory(scratch / "out");
  REQUIRE_FALSE(run(directory.path(), 5, false));
  REQUIRE_FALSE(run(directory.path(), 5, true));
  REQUIRE(fs::exists(directory.previous_checkpoint()));
  fs::resize_file(directory.checkpoint(), fs::file_size(directory.checkpoint()) / 3);
  CHECK_THROWS_AS(read_checkpoint(directory.checkpoint()), IoError);
  CHECK(newest_checkpoint(directory)->at.step == 5);
  write_file(directory.previous_checkpoint(), "no HDF5");
  CHECK_THROWS_WITH(newest_checkpoint(directory), Catch::Contains("--overwrite"));
}

TEST_CASE("no damaged byte of a checkpoint goes unnoticed", "[resume]") {
  const Scratch scratch;
  const ResultsDirectory directory(scratch / "out");
  REQUIRE_FALSE(run(directory.path(), 5, false));
  const Checkpoint whole = read_checkpoint(directory.checkpoint());
  const std::string good = read_file(directory.checkpoint());
  for (std::size_t at = 0; at + 4 < good.size(); at += 97) {
    std::string bad = good;
    for (std::size_t k = 0; k < 4; ++k) bad[at + k] = static_cast<char>(~bad[at + k]);
    std::ofstream(scratch / "bad.h5", std::ios::binary) << bad;
    INFO("byte " << at << " of " << good.size());
    CHECK(damage_is_harmless(scratch / "bad.h5", whole));
  }
}

TEST_CASE("a non-finite state never becomes a checkpoint") {
  const Scratch scratch;
  const RawArray array{"x", "f4", {1}, {0, 0, 0xc0, 0x7f}};  // a quiet NaN
  CHECK_THROWS_AS(require_finite({}, {array}), NumericsError);
  const deck::Deck deck = ballistic_deck();
  const Model model = testing::ballistic_model();
  const ResultsDirectory directory(scratch / "run");
  Ballistic solver(model);
  ResultsRecorder recorder(directory, deck, model, solver, "cpu", true);
  CHECK_THROWS_AS(recorder.checkpoint({}, std::make_shared<const std::vector<RawArray>>(1, array), 0), NumericsError);
  recorder.wait();
  CHECK_FALSE(fs::exists(directory.checkpoint()));
}

TEST_CASE("only the end and output may differ when a run resumes") {
  const std::string before = R"({"time": {"end": 1, "step": 0.1}, "gravity": [0, -10], "output": {"interval": 1}})";
  CHECK_NOTHROW(require_same_deck(before, R"({"time": {"end": 2, "step": 0.1}, "gravity": [0, -10], "output": {"interval": 3}})", "c.h5"));
  try {
    require_same_deck(before, R"({"time": {"end": 1, "step": 0.2}, "gravity": [0, -9], "output": {"interval": 1}})", "c.h5");
    FAIL("accepted");
  } catch (const DeckError& error) {
    REQUIRE(error.problems.size() == 2);
    CHECK(error.problems[0].pointer == "/gravity/1");
    CHECK(error.problems[1].pointer == "/time/step");
    CHECK(error.problems[1].message.find("0.2 but was 0.1") != std::string::npos);
  }
}

TEST_CASE("results are cleared, and nothing else") {
  const Scratch scratch;
  const ResultsDirectory directory(scratch / "out");
  CHECK_FALSE(directory.holds_results());
  REQUIRE_FALSE(run(directory.path(), 30, false));
  write_file(directory.path() + "/notes.txt", "mine");
  write_file(directory.path() + "/frames/mine.h5", "mine");
  CHECK(directory.holds_results());
  directory.clear();
  CHECK_FALSE(directory.holds_results());
  CHECK(fs::exists(directory.path() + "/notes.txt"));
  CHECK(fs::exists(directory.path() + "/frames/mine.h5"));
}

TEST_CASE("VTK's own reader finds particles, fields and time") {
  const Scratch scratch;
  const std::string path = scratch / "out";
  REQUIRE(run(path, never, false));
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((path + "/vtk/000002.vtp").c_str());
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  CHECK(data->GetNumberOfPoints() == 5);
  CHECK(data->GetNumberOfVerts() == 5);
  for (const char* field : {"id", "body", "velocity", "pressure"}) CHECK(data->GetPointData()->HasArray(field));
  const hdf5::Reader frame(path + "/frames/000002.h5");
  const std::vector<double> x = frame.numbers("/stone/position"), v = frame.numbers("/stone/velocity");
  CHECK(data->GetPoint(3)[1] == x[7]);
  CHECK(data->GetPointData()->GetArray("velocity")->GetNumberOfComponents() == 3);
  CHECK(data->GetPointData()->GetArray("velocity")->GetComponent(3, 0) == Approx(v[6]).epsilon(1e-6));
  CHECK(data->GetPointData()->GetArray("velocity")->GetComponent(3, 2) == 0);
  CHECK(data->GetFieldData()->GetArray("TimeValue")->GetTuple1(0) == frame.number_attribute("/", "time"));
}
