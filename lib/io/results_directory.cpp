#include "io/results_directory.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "io/files.hpp"

namespace jaxmpm {
namespace {

namespace fs = std::filesystem;

std::string join(const std::string& directory, const std::string& name) { return (fs::path(directory) / name).string(); }

/// The number in a frame's file name, −1 when it is another kind of file. A temporary one that a kill left behind counts too.
long frame_number(const fs::path& file) {
  fs::path name = file.filename();
  if (name.extension() == ".tmp") name = name.stem();
  const std::string stem = name.stem().string(), ending = name.extension().string();
  if ((ending != ".h5" && ending != ".vtp") || stem.size() < 6 || stem.size() > 12 ||
      !std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; }))
    return -1;
  return std::stol(stem);
}

}  // namespace

std::string frame_name(std::size_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%06zu", number);
  return text;
}

ResultsDirectory::ResultsDirectory(std::string path) : path_(std::move(path)) {}

std::string ResultsDirectory::frame_link(std::size_t number) const { return "frames/" + frame_name(number) + ".h5"; }
std::string ResultsDirectory::frame(std::size_t number) const { return join(path_, frame_link(number)); }
std::string ResultsDirectory::vtk_frame(std::size_t number) const { return join(path_, "vtk/" + frame_name(number) + ".vtp"); }
std::string ResultsDirectory::vtk_series() const { return join(path_, "vtk/results.pvd"); }
std::string ResultsDirectory::vtk_obstacles() const { return join(path_, "vtk/obstacles.vtp"); }
std::string ResultsDirectory::index() const { return join(path_, "results.h5"); }
std::string ResultsDirectory::checkpoint() const { return join(path_, "checkpoint.h5"); }
std::string ResultsDirectory::previous_checkpoint() const { return join(path_, "checkpoint.previous.h5"); }
std::string ResultsDirectory::next_checkpoint() const { return join(path_, "checkpoint.next.h5"); }
std::string ResultsDirectory::summary() const { return join(path_, "run.json"); }

std::vector<std::string> ResultsDirectory::frame_files(std::size_t first) const {
  std::vector<std::string> files;
  for (const char* room : {"frames", "vtk"}) {
    std::error_code missing;
    for (const fs::directory_entry& entry : fs::directory_iterator(join(path_, room), missing))
      if (frame_number(entry.path()) >= static_cast<long>(first)) files.push_back(entry.path().string());
  }
  return files;
}

bool ResultsDirectory::holds_results() const {
  for (const std::string& file : {index(), next_checkpoint(), checkpoint(), previous_checkpoint(), summary(), vtk_series()})
    if (fs::exists(file)) return true;
  return !frame_files(0).empty();
}

void ResultsDirectory::prepare(const std::vector<std::string>& formats) const {
  make_directory(path_);
  for (const std::string& format : formats) make_directory(join(path_, format == "hdf5" ? "frames" : format));
}

void ResultsDirectory::clear() const {
  drop_frames_from(0);
  for (const std::string& file :
       {index(), next_checkpoint(), checkpoint(), previous_checkpoint(), summary(), vtk_series(), vtk_obstacles()})
    remove_file(file);
}

void ResultsDirectory::adopt_frames(const ResultsDirectory& from, std::size_t count) const {
  const auto adopt = [](const std::string& source, const std::string& target) {
    if (fs::exists(source) && fs::exists(fs::path(target).parent_path()) && !fs::exists(target)) write_file(target, read_file(source));
  };
  for (std::size_t n = 0; n < count; ++n) {
    adopt(from.frame(n), frame(n));
    adopt(from.vtk_frame(n), vtk_frame(n));
  }
}

std::size_t ResultsDirectory::missing_frames(std::size_t count) const {
  const auto missing = [](const std::string& file) { return fs::exists(fs::path(file).parent_path()) && !fs::exists(file); };
  std::size_t found = 0;
  for (std::size_t n = 0; n < count; ++n) found += missing(frame(n)) || missing(vtk_frame(n));
  return found;
}

void ResultsDirectory::drop_frames_from(std::size_t first) const {
  for (const std::string& file : frame_files(first)) remove_file(file);
}

}  // namespace jaxmpm
