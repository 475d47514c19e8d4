#include "io/index.hpp"

#include <filesystem>

#include "core/provenance.hpp"
#include "io/hdf5.hpp"

namespace jaxmpm {
namespace {

constexpr std::uint64_t results_format = 1;

void write_channel(hdf5::Writer& file, const std::string& group, const GaugeSeries& series, const Channel& channel, std::size_t offset) {
  const std::size_t times = series.time.size(), width = series.width(), size = channel.size();
  std::vector<double> values;
  values.reserve(times * size);
  for (std::size_t t = 0; t < times; ++t)
    for (std::size_t k = 0; k < size; ++k) values.push_back(series.values[t * width + offset + k]);
  std::vector<std::size_t> shape = channel.shape;
  shape.insert(shape.begin(), times);
  file.dataset(group + "/" + channel.name, shape, values);
  file.attribute(group + "/" + channel.name, "units", channel.unit);
  if (!channel.components.empty()) file.attribute(group + "/" + channel.name, "components", channel.components);
}

void write_series(hdf5::Writer& file, const std::string& group, const GaugeSeries& series) {
  file.dataset(group + "/time", {series.time.size()}, series.time);
  file.attribute(group + "/time", "units", "s");
  file.dataset(group + "/valid", "u1", {series.valid.size()}, series.valid.data());
  std::size_t offset = 0;
  for (const Channel& channel : series.channels) {
    write_channel(file, group, series, channel, offset);
    offset += channel.size();
  }
}

}  // namespace

std::string precision_name(deck::Precision precision) { return precision == deck::Precision::f32 ? "f32" : "f64"; }

void write_index(const ResultsDirectory& directory, const deck::Deck& deck, const std::string& backend,
                 const std::vector<FrameEntry>& frames, const std::map<std::string, GaugeSeries>& gauges) {
  hdf5::Writer file(directory.index());
  file.attribute("/", "format", results_format);
  file.attribute("/", "version", provenance().version);
  file.attribute("/", "title", deck.title);
  file.attribute("/", "deck", deck.as_given);
  file.attribute("/", "deck_resolved", deck.resolved);
  file.attribute("/", "git_commit", provenance().git_commit);
  file.attribute("/", "backend", backend);
  file.attribute("/", "precision", precision_name(deck.method.precision));
  file.group("/frames");
  for (std::size_t n = 0; n < frames.size(); ++n)
    if (std::filesystem::exists(directory.frame(n))) file.external_link("/frames/" + frame_name(n), directory.frame_link(n), "/");
  file.group("/gauges");
  for (const auto& [name, series] : gauges) write_series(file, "/gauges/" + name, series);
  file.finish();
}

std::string deck_of_results(const ResultsDirectory& directory) {
  if (!std::filesystem::exists(directory.index())) return {};
  try {
    return hdf5::Reader(directory.index()).text_attribute("/", "deck_resolved");
  } catch (const IoError&) {
    return {};
  }
}

}  // namespace jaxmpm
