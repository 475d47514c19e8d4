#include "io/recorder.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "core/runtime.hpp"
#include "io/files.hpp"
#include "io/vtk.hpp"

namespace jaxmpm {

ResultsRecorder::ResultsRecorder(const ResultsDirectory& directory, const deck::Deck& deck, const Model& model, Solver& solver,
                                 const std::string& backend, bool quiet)
    : directory_(directory),
      deck_(deck),
      model_(model),
      solver_(solver),
      backend_(backend),
      gauges_(deck, model),
      progress_(solver.particle_count(), quiet),
      writer_(backend != "cpu" || thread_count() > 1) {
  for (const Body& body : model.bodies) {
    layout_.push_back({body.name, deck.output.fields.value()});
    fields_ = fields_ | selection(layout_.back().fields);
  }
  if (gauges_.needs_forces()) solver.record_forces(true);
}

bool ResultsRecorder::writes(const std::string& format) const {
  return std::find(deck_.output.formats.begin(), deck_.output.formats.end(), format) != deck_.output.formats.end();
}

void ResultsRecorder::resume(const Checkpoint& from) {
  frames_ = from.frames;
  gauges_.restore(from.gauges);
  directory_.drop_frames_from(frames_.size());
}

void ResultsRecorder::begin() {
  if (writes("vtk") && !model_.obstacles.empty()) write_vtk_obstacles(directory_.vtk_obstacles(), deck_, model_);
  write_index();
}

void ResultsRecorder::frame(const Moment& now) {
  if (!frames_.empty() && frames_.back().step == now.step) return;  // a rescue comes back to a step that has its frame
  writer_.wait();
  solver_.take_snapshot(fields_, true, snapshot_);
  require_finite(now, layout_, snapshot_, model_.dim);
  frames_.push_back({now.step, now.time});
  writer_.start([this, now, frames = frames_, gauges = gauges_.series()] {
    write_frame_files(now, frames);
    snapshot_ = {};
    ::jaxmpm::write_index(directory_, deck_, backend_, frames, gauges);
    spdlog::debug("frame {} at {:.9g} s, step {}", frames.size() - 1, now.time, now.step);
  });
}

void ResultsRecorder::write_frame_files(const Moment& now, const std::vector<FrameEntry>& frames) const {
  const std::size_t number = frames.size() - 1;
  if (writes("hdf5")) write_frame(directory_.frame(number), now, layout_, snapshot_, model_.dim);
  if (!writes("vtk")) return;
  write_vtk_frame(directory_.vtk_frame(number), now, layout_, snapshot_, model_.dim);
  write_vtk_series(directory_, frames);
}

void ResultsRecorder::gauges(const Moment& now) { gauges_.measure(now, solver_); }

void ResultsRecorder::write_index() const { ::jaxmpm::write_index(directory_, deck_, backend_, frames_, gauges_.series()); }

void ResultsRecorder::drop_after(std::uint64_t step) {
  gauges_.drop_after(step);
  while (!frames_.empty() && frames_.back().step > step) frames_.pop_back();
}

void ResultsRecorder::checkpoint(const Moment& now, SavedState state, double seconds) {
  require_finite(now, *state);
  writer_.wait();
  drop_after(now.step);  // a rescue goes back to before the failure
  writer_.start([this, whole = Checkpoint{now, seconds, deck_.resolved, backend_, frames_, gauges_.series(), std::move(state)}] {
    const std::string next = directory_.next_checkpoint();
    write_checkpoint(next, whole);
    // A kill between the renames leaves the new one under its first name; resume looks there too.
    if (std::filesystem::exists(directory_.checkpoint())) rename_file(directory_.checkpoint(), directory_.previous_checkpoint());
    rename_file(next, directory_.checkpoint());
    spdlog::debug("checkpoint at {:.9g} s, step {}", whole.at.time, whole.at.step);
  });
}

void ResultsRecorder::finish() {
  progress_.finish();
  writer_.wait();
  write_index();
}

void ResultsRecorder::progress(const Moment& now, double end) { progress_.update(now, end); }

}  // namespace jaxmpm
