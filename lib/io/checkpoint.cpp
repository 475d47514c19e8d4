#include "io/checkpoint.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/describe_place.hpp"
#include "core/error.hpp"
#include "core/provenance.hpp"
#include "io/hdf5.hpp"

namespace jaxmpm {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t checkpoint_format = 1;
const char* const kind = "jaxmpm checkpoint";

template <class Real>
bool is_finite(const std::vector<unsigned char>& bytes) {
  for (std::size_t at = 0; at + sizeof(Real) <= bytes.size(); at += sizeof(Real)) {
    Real value;
    std::memcpy(&value, &bytes[at], sizeof(Real));
    if (!std::isfinite(value)) return false;
  }
  return true;
}

void write_frames(hdf5::Writer& file, const std::vector<FrameEntry>& frames) {
  std::vector<std::uint64_t> steps;
  std::vector<double> times;
  for (const FrameEntry& frame : frames) {
    steps.push_back(frame.step);
    times.push_back(frame.time);
  }
  file.dataset("/frames/step", "u8", {steps.size()}, steps.data(), hdf5::Storage::checked);
  file.dataset("/frames/time", {times.size()}, times, hdf5::Storage::checked);
}

std::vector<FrameEntry> read_frames(const hdf5::Reader& file) {
  const auto steps = file.counts("/frames/step");
  const auto times = file.numbers("/frames/time");
  if (steps.size() != times.size())
    throw IoError("'" + file.path() + "' is damaged: its frames have " + std::to_string(steps.size()) + " steps and " +
                  std::to_string(times.size()) + " times.");
  std::vector<FrameEntry> frames;
  for (std::size_t n = 0; n < steps.size(); ++n) frames.push_back({steps[n], times[n]});
  return frames;
}

// Channels are the deck's to say; one channel of the whole width stands for them here.
void write_gauge(hdf5::Writer& file, const std::string& group, const GaugeSeries& series) {
  file.dataset(group + "/step", "u8", {series.step.size()}, series.step.data(), hdf5::Storage::checked);
  file.dataset(group + "/time", {series.time.size()}, series.time, hdf5::Storage::checked);
  file.dataset(group + "/valid", "u1", {series.valid.size()}, series.valid.data(), hdf5::Storage::checked);
  file.dataset(group + "/values", {series.time.size(), series.width()}, series.values, hdf5::Storage::checked);
}

GaugeSeries read_gauge(const hdf5::Reader& file, const std::string& group) {
  GaugeSeries series;
  const std::vector<std::size_t> shape = file.shape(group + "/values");
  if (shape.size() != 2) throw IoError("'" + file.path() + "' is damaged: " + group + "/values is no table.");
  series.channels = {{"", "", {shape[1]}, {}}};
  series.step = file.counts(group + "/step");
  series.time = file.numbers(group + "/time");
  series.valid = file.bytes(group + "/valid");
  series.values = file.numbers(group + "/values");
  return series;
}

}  // namespace

void require_finite(const Moment& at, const std::vector<RawArray>& state) {
  for (const RawArray& array : state)
    if ((array.type == "f8" && !is_finite<double>(array.bytes)) || (array.type == "f4" && !is_finite<float>(array.bytes)))
      throw NumericsError("the state at step " + std::to_string(at.step) + " is not finite (" + array.name +
                          "), so it is not written as a checkpoint.");
}

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  hdf5::Writer file(path);
  file.attribute("/", "kind", std::string(kind));
  file.attribute("/", "format", checkpoint_format);
  file.attribute("/", "version", provenance().version);
  file.attribute("/", "git_commit", provenance().git_commit);
  file.text("/backend", checkpoint.backend);
  file.text("/deck_resolved", checkpoint.deck);
  file.attribute("/", "step", checkpoint.at.step);
  file.attribute("/", "time", checkpoint.at.time);
  file.attribute("/", "dt", checkpoint.at.dt);
  file.attribute("/", "before", checkpoint.at.before);
  file.attribute("/", "seconds", checkpoint.seconds);
  write_frames(file, checkpoint.frames);
  file.group("/gauges");
  for (const auto& [name, series] : checkpoint.gauges) write_gauge(file, "/gauges/" + name, series);
  file.group("/state");
  for (std::size_t n = 0; n < checkpoint.state->size(); ++n) {
    const RawArray& array = (*checkpoint.state)[n];
    const std::string place = "/state/" + frame_name(n);  // the solver's own names may hold slashes
    file.text(place + "/name", array.name);
    file.dataset(place + "/values", array.type, array.shape, array.bytes.data(), hdf5::Storage::checked);
  }
  file.finish();
}

Checkpoint read_checkpoint(const std::string& path) {
  if (!fs::exists(path)) throw IoError("there is no checkpoint '" + path + "'.");
  const hdf5::Reader file(path);
  if (file.text_attribute("/", "kind") != kind || file.count_attribute("/", "format") != checkpoint_format)
    throw IoError("'" + path + "' is no checkpoint of format " + std::to_string(checkpoint_format) +
                  "; resume with the version of jaxmpm that wrote it.");
  Checkpoint found;
  found.at = {file.count_attribute("/", "step"), file.number_attribute("/", "time"), file.number_attribute("/", "dt"),
              file.number_attribute("/", "before")};
  found.seconds = file.number_attribute("/", "seconds");
  found.deck = file.text("/deck_resolved");
  found.backend = file.text("/backend");
  found.frames = read_frames(file);
  for (const std::string& name : file.names("/gauges")) found.gauges[name] = read_gauge(file, "/gauges/" + name);
  std::vector<RawArray> state;
  for (const std::string& name : file.names("/state")) {
    const std::string place = "/state/" + name;
    state.push_back(
        {file.text(place + "/name"), file.type(place + "/values"), file.shape(place + "/values"), file.bytes(place + "/values")});
  }
  found.state = std::make_shared<const std::vector<RawArray>>(std::move(state));
  return found;
}

std::optional<Checkpoint> newest_checkpoint(const ResultsDirectory& directory) {
  std::string damage;
  for (const std::string& path : {directory.next_checkpoint(), directory.checkpoint(), directory.previous_checkpoint()}) {
    if (!fs::exists(path)) continue;
    try {
      return read_checkpoint(path);
    } catch (const IoError& error) {
      spdlog::warn("{}", error.what());
      damage += (damage.empty() ? "" : "\n") + std::string(error.what());
    }
  }
  if (damage.empty()) return std::nullopt;
  throw IoError(damage + "\nNo checkpoint in '" + directory.path() +
                "' can be read. Start the run anew with --overwrite, or give --resume a good checkpoint.");
}

void require_same_deck(const std::string& before, const std::string& now, const std::string& file,
                       const std::vector<std::string>& may_change) {
  using Json = nlohmann::json;
  const auto relevant = [&may_change](const std::string& text) {
    Json deck = Json::parse(text, nullptr, false, true);
    if (!deck.is_object()) return deck;
    deck.erase("$schema");
    for (const std::string& pointer : may_change) {
      const Json::json_pointer place(pointer);
      if (deck.contains(place) && deck[place.parent_pointer()].is_object()) deck[place.parent_pointer()].erase(place.back());
    }
    return deck;
  };
  const Json old_deck = relevant(before), new_deck = relevant(now);
  std::vector<Problem> problems;
  for (const Json& change : Json::diff(old_deck, new_deck)) {
    const std::string pointer = change["path"];
    const Json::json_pointer place(pointer);
    const auto shown = [&](const Json& deck) { return deck.contains(place) ? deck.at(place).dump() : std::string("nothing"); };
    problems.push_back({pointer, 0,
                        "is " + shown(new_deck) + " but was " + shown(old_deck) + " in '" + file + "'. What may change on resuming is " +
                            described::listed(may_change) + "; put it back, or start anew with --overwrite or another -o."});
  }
  if (!problems.empty()) throw DeckError(problems);
}

}  // namespace jaxmpm
