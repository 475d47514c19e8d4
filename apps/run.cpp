// jaxmpm run: from deck to results.
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/logging.hpp"
#include "core/provenance.hpp"
#include "core/runtime.hpp"
#include "core/signals.hpp"
#include "io/files.hpp"
#include "io/recorder.hpp"
#include "io/summary.hpp"

namespace jaxmpm {
namespace {

/// Finds the checkpoint to resume from, if one is asked for and there is one, and refuses what must not be overwritten or continued.
std::optional<Checkpoint> find_start(const ResultsOptions& options, const deck::Deck& deck, const ResultsDirectory& directory,
                                     const std::string& backend) {
  if (!options.resume) {
    if (!options.overwrite && directory.holds_results())
      throw IoError(
          "'" + directory.path() +
          "' holds results. Continue them with --resume auto, replace them with --overwrite, or choose another directory with -o.");
    return std::nullopt;
  }
  std::optional<Checkpoint> from;
  std::string file = directory.path();
  if (*options.resume == "auto") {
    from = newest_checkpoint(directory);
    const std::string before = from ? from->deck : deck_of_results(directory);
    if (!before.empty()) require_same_deck(before, deck.resolved, file);
    if (!from) spdlog::info("There is no checkpoint in '{}': the run starts at the beginning.", file);
  } else {
    file = *options.resume;
    from = read_checkpoint(file);
    require_same_deck(from->deck, deck.resolved, file);
  }
  if (from && from->backend != backend)
    throw Error(ExitCode::deck,
                "'" + file + "' is of a run on the backend " + from->backend + "; resume it with --backend " + from->backend + ".");
  if (from && from->at.time > deck.time.end * (1 + 1e-9))
    throw DeckError("/time/end", fmt::format("is {:.9g} s, but '{}' has already reached {:.9g} s; give a later end.", deck.time.end, file,
                                             from->at.time));
  return from;
}

/// A checkpoint of another directory brings its frames along.
void adopt_frames(const ResultsOptions& options, const ResultsDirectory& directory, const Checkpoint& from) {
  if (*options.resume == "auto") return;
  const std::filesystem::path home = std::filesystem::absolute(*options.resume).parent_path();
  if (std::filesystem::equivalent(home, directory.path())) return;
  if (directory.holds_results())
    throw IoError("'" + directory.path() + "' holds results other than those of '" + *options.resume +
                  "'; choose another directory with -o.");
  directory.adopt_frames(ResultsDirectory(home.string()), from.frames.size());
}

/// Says which of a checkpoint's frames the results go without.
void warn_of_missing_frames(const ResultsDirectory& directory, const Checkpoint& from) {
  if (const std::size_t missing = directory.missing_frames(from.frames.size()))
    spdlog::warn(
        "{} of the {} frames before the checkpoint are in neither its directory nor '{}': the results go without them. "
        "To have them, put frames/ and vtk/ of that run beside the checkpoint and resume into another directory (-o).",
        missing, from.frames.size(), directory.path());
}

RunSettings settings(const deck::Deck& deck, const ResultsOptions& options) {
  RunSettings settings;
  settings.frame_interval = deck.output.interval;
  settings.gauge_interval = deck.output.gauge_interval.value_or(deck.output.interval);
  settings.checkpoint_seconds = 60 * deck.output.checkpoint_interval_minutes;
  settings.walltime_seconds = 60 * options.max_walltime;
  settings.stop_requested = [] { return stop_signal() != 0; };
  return settings;
}

class Run {
 public:
  explicit Run(const ResultsOptions& options, bool quiet)
      : options_(options),
        deck_(read(options)),
        directory_(deck_.output.directory),
        backend_(chosen_backend(options)),
        from_(find_start(options, deck_, directory_, backend_name(backend_))),
        model_(build_model(deck_)),
        solver_(make_solver(model_, backend_)),
        first_count_(solver_->particle_count()),
        recorder_(directory_, deck_, model_, *solver_, backend_name(backend_), quiet),
        simulation_(model_.time, settings(deck_, options), *solver_, recorder_) {
    for (Body& body : model_.bodies) body.initial = {};  // the solver has it now
    for (const std::string& notice : model_.notices) spdlog::info("Note: {}", notice);
    for (const std::string& notice : simulation_.notices()) spdlog::info("Note: {}", notice);
    if (const std::string warning = large_step_warning(model_, *solver_); !warning.empty()) spdlog::warn(warning);
  }

  int operator()() {
    prepare();
    spdlog::info("{}: {} particles, {} threads, results in '{}'", deck_.title.empty() ? options_.deck : deck_.title,
                 solver_->particle_count(), thread_count(), directory_.path());
    RunStart start;
    if (from_) start = {from_->at, true, from_->seconds};
    from_.reset();
    try {
      const RunOutcome outcome = simulation_.run(start);
      recorder_.finish();
      summarise(outcome, start);
      return report(outcome, outcome.seconds - start.seconds);
    } catch (const NumericsError&) {
      recorder_.finish();
      throw;
    }
  }

 private:
  void prepare() {
    if (from_) solver_->restore(*from_->state);
    directory_.prepare(deck_.output.formats);
    if (from_) {
      adopt_frames(options_, directory_, *from_);
      warn_of_missing_frames(directory_, *from_);
      recorder_.resume(*from_);
      spdlog::info("Resumed at {:.9g} s, step {}.", from_->at.time, from_->at.step);
    } else directory_.clear();
    recorder_.begin();
  }

  void summarise(const RunOutcome& outcome, const RunStart& start) const {
    nlohmann::ordered_json json;
    json["title"] = deck_.title;
    json["outcome"] = outcome.finished ? "done" : "stopped";
    json["time"] = outcome.at.time;
    json["frames"] = recorder_.frame_count();
    json["total_steps"] = outcome.at.step;
    json["total_seconds"] = outcome.seconds;
    if (model_.has_open_face()) json["particles_left"] = left();
    json.update(cost_summary(model_, *solver_, backend_, outcome.steps, outcome.seconds - start.seconds, solver_->phase_seconds()));
    json["cpu_seconds"] = outcome.cpu_seconds;
    const OutputSeconds& output = outcome.output;
    json["seconds_by_output"] = {
        {"frames", output.frames}, {"gauges", output.gauges}, {"checkpoints", output.checkpoints}, {"beside", output.beside}};
    write_file(directory_.summary(), json.dump(2) + "\n");
  }

  /// Particles that have passed open faces.
  std::uint64_t left() const { return first_count_ - solver_->particle_count(); }

  /// `seconds`: of this process's steps.
  int report(const RunOutcome& outcome, double seconds) const {
    const double rate = static_cast<double>(solver_->particle_count()) * static_cast<double>(outcome.steps);
    spdlog::info("{} at {:.9g} s after {} steps, {} in steps ({:.3g} particle-steps/s), {} frames.", outcome.finished ? "Done" : "Stopped",
                 outcome.at.time, outcome.at.step, duration(outcome.seconds), seconds > 0 ? rate / seconds : 0, recorder_.frame_count());
    if (model_.has_open_face()) spdlog::info("{} of {} particles have left through open faces.", left(), first_count_);
    if (outcome.finished) {
      if (const std::string note = moving_note(model_, *solver_, outcome.at.time); !note.empty()) spdlog::info("Note: {}", note);
      return static_cast<int>(ExitCode::done);
    }
    spdlog::info("Continue with: jaxmpm run {} --resume auto (and the same -o and --set)", options_.deck);
    return static_cast<int>(ExitCode::stopped);
  }

  const ResultsOptions& options_;
  deck::Deck deck_;
  ResultsDirectory directory_;
  Backend backend_;
  std::optional<Checkpoint> from_;
  Model model_;
  std::unique_ptr<Solver> solver_;
  std::uint64_t first_count_;
  ResultsRecorder recorder_;
  Simulation simulation_;
};

}  // namespace

int run(const ResultsOptions& options, bool quiet) {
  watch_signals();
  const Runtime runtime(options.threads);
  return Run(options, quiet)();
}

}  // namespace jaxmpm
