#include "io/results_reader.hpp"

#include <array>
#include <cstring>
#include <fstream>

#include "core/error.hpp"

namespace jaxmpm {

bool is_hdf5(const std::string& path) {
  std::array<char, 4> first{};
  std::ifstream(path, std::ios::binary).read(first.data(), first.size());
  return std::memcmp(first.data(), "\x89HDF", first.size()) == 0;
}

ResultsReader::ResultsReader(const std::string& path) : path_(path), file_(path) {
  if (!file_.has("/frames") || !file_.has("/gauges"))
    throw IoError("'" + path + "' is HDF5, but no results.h5 of a run: it has no /frames and /gauges.");
  frames_ = file_.names("/frames");
  for (const std::string& frame : frames_) times_.push_back(file_.number_attribute("/frames/" + frame, "time"));
}

std::string ResultsReader::object(std::size_t frame, const std::string& body, const std::string& field) const {
  return "/frames/" + frames_.at(frame) + "/" + body + "/" + field;
}

std::vector<std::string> ResultsReader::bodies(std::size_t frame) const { return file_.names("/frames/" + frames_.at(frame)); }

bool ResultsReader::has_field(std::size_t frame, const std::string& body, const std::string& field) const {
  return file_.has(object(frame, body, field));
}

std::vector<double> ResultsReader::field(std::size_t frame, const std::string& body, const std::string& field) const {
  return file_.numbers(object(frame, body, field));
}

std::vector<std::uint64_t> ResultsReader::ids(std::size_t frame, const std::string& body) const {
  return file_.counts(object(frame, body, "id"));
}

std::vector<std::string> ResultsReader::gauges() const { return file_.names("/gauges"); }

GaugeReadings ResultsReader::gauge(const std::string& name, const std::vector<std::string>& datasets) const {
  const std::string group = "/gauges/" + name + "/";
  GaugeReadings readings;
  readings.time = file_.numbers(group + "time");
  for (const double valid : file_.numbers(group + "valid")) readings.valid.push_back(valid != 0);
  std::vector<std::vector<double>> channels;
  for (const std::string& dataset : datasets) channels.push_back(file_.numbers(group + dataset));
  const std::size_t times = readings.time.size();
  for (std::size_t t = 0; t < times; ++t)
    for (const std::vector<double>& channel : channels) {
      const std::size_t size = channel.size() / times;
      readings.values.insert(readings.values.end(), channel.begin() + static_cast<std::ptrdiff_t>(t * size),
                             channel.begin() + static_cast<std::ptrdiff_t>((t + 1) * size));
    }
  readings.width = times > 0 ? readings.values.size() / times : 0;
  return readings;
}

std::string ResultsReader::deck() const { return file_.text_attribute("/", "deck_resolved"); }

}  // namespace jaxmpm
