#pragma once
// Results of a run, read back: what observations compare another run with.
#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5.hpp"

namespace jaxmpm {

/// Whether a file begins as HDF5 does; not so where it cannot be read.
bool is_hdf5(const std::string& path);

/// One gauge's readings: the values of the datasets asked for one after another at each time.
struct GaugeReadings {
  std::vector<double> time;  // s
  std::vector<bool> valid;
  std::size_t width = 0;       // numbers at each time
  std::vector<double> values;  // T × width
};

/// A results.h5 with its frames (docs/results.md). Every call throws IoError when a file is damaged or missing.
class ResultsReader {
 public:
  explicit ResultsReader(const std::string& path);
  const std::string& path() const { return path_; }
  /// Times of the frames, s, in their order.
  const std::vector<double>& frame_times() const { return times_; }
  std::vector<std::string> bodies(std::size_t frame) const;
  bool has_field(std::size_t frame, const std::string& body, const std::string& field) const;
  std::vector<double> field(std::size_t frame, const std::string& body, const std::string& field) const;
  std::vector<std::uint64_t> ids(std::size_t frame, const std::string& body) const;
  std::vector<std::string> gauges() const;
  /// `datasets`: "value" for most kinds, the fields for a particles gauge.
  GaugeReadings gauge(const std::string& name, const std::vector<std::string>& datasets) const;
  /// The deck it was run with, JSON with every default filled in.
  std::string deck() const;

 private:
  std::string object(std::size_t frame, const std::string& body, const std::string& field) const;

  std::string path_;
  hdf5::Reader file_;
  std::vector<std::string> frames_;
  std::vector<double> times_;
};

}  // namespace jaxmpm
