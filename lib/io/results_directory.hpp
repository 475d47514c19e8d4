#pragma once
// Names of everything in a results directory (docs/results.md), and what may be done with what lies there.
#include <string>
#include <vector>

namespace jaxmpm {

class ResultsDirectory {
 public:
  explicit ResultsDirectory(std::string path);
  const std::string& path() const { return path_; }
  std::string frame(std::size_t number) const;       ///< DIR/frames/000123.h5
  std::string frame_link(std::size_t number) const;  ///< frames/000123.h5, as results.h5 names it
  std::string vtk_frame(std::size_t number) const;   ///< DIR/vtk/000123.vtp
  std::string vtk_series() const;                    ///< DIR/vtk/results.pvd
  std::string vtk_obstacles() const;                 ///< DIR/vtk/obstacles.vtp
  std::string index() const;                         ///< DIR/results.h5
  std::string checkpoint() const;
  std::string previous_checkpoint() const;
  std::string next_checkpoint() const;  ///< complete, on its way to checkpoint()
  std::string summary() const;          ///< DIR/run.json

  bool holds_results() const;
  /// Makes the directory and those of the formats. Throws IoError when it cannot be written.
  void prepare(const std::vector<std::string>& formats) const;
  /// Removes results, and nothing else. Throws IoError.
  void clear() const;
  /// Copies those of the first `count` frames that are missing here from another results directory. Throws IoError.
  void adopt_frames(const ResultsDirectory& from, std::size_t count) const;
  /// How many of the first `count` frames are not there, in a format whose folder is.
  std::size_t missing_frames(std::size_t count) const;
  /// Removes frames from number `first` on, of both formats.
  void drop_frames_from(std::size_t first) const;

 private:
  std::vector<std::string> frame_files(std::size_t first) const;
  std::string path_;
};

/// Six digits, as frames are numbered.
std::string frame_name(std::size_t number);

}  // namespace jaxmpm
