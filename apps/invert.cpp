// jaxmpm invert: finds the unknowns of a deck from its observations.
#include <functional>

#include "commands.hpp"
#include "core/error.hpp"
#include "core/logging.hpp"
#include "core/runtime.hpp"
#include "core/signals.hpp"
#include "core/stopwatch.hpp"
#include "inverse/inversion.hpp"
#include "inverse/run_objective.hpp"

namespace jaxmpm {
namespace {

/// A signal, or the end of the wall time.
std::function<bool()> stop_request(double minutes) {
  return [watch = Stopwatch(), minutes] { return stop_signal() != 0 || (minutes > 0 && watch.seconds() >= 60 * minutes); };
}

/// The --set and --backend of a call, to be typed again.
std::string options_of(const ResultsOptions& options) {
  std::string text;
  if (options.backend) text += " --backend " + *options.backend;
  for (const std::string& one : options.assignments) text += " --set '" + one + "'";
  return text;
}

void refuse_to_overwrite(const ResultsOptions& options, const InversionDirectory& directory) {
  if (options.resume || options.overwrite || !directory.holds_inversion()) return;
  throw IoError("'" + directory.path() +
                "' holds an inversion. Continue it with --resume auto, replace it with --overwrite, or choose another directory with -o.");
}

}  // namespace

int invert(const ResultsOptions& options) {
  watch_signals();
  const Runtime runtime(options.threads);
  const deck::Deck deck = read(options);
  const InversionDirectory directory(deck.output.directory);
  refuse_to_overwrite(options, directory);
  const Unknowns unknowns(deck);
  check_bounds(deck, unknowns);
  directory.protect_inputs(deck, unknowns);
  std::vector<RecordedEvaluation> before;
  if (options.resume) before = directory.read(deck, unknowns);
  if (options.resume && before.empty()) spdlog::info("There is no inversion in '{}': it starts at the beginning.", directory.path());
  RunObjective objective(deck, chosen_backend(options), unknowns.pointers(), stop_request(options.max_walltime));
  Inversion inversion(deck, unknowns, objective, directory, std::move(before));
  directory.prepare();
  if (options.overwrite) directory.clear(deck, unknowns);
  spdlog::info("{}: {} unknowns, {}, {} threads, results in '{}'", deck.title.empty() ? options.deck : deck.title, unknowns.size(),
               objective.backend(), thread_count(), directory.path());
  if (inversion.run()) return static_cast<int>(ExitCode::done);
  spdlog::info("Stopped. Continue with: jaxmpm invert {} -o '{}'{} --resume auto", options.deck, directory.path(), options_of(options));
  return static_cast<int>(ExitCode::stopped);
}

}  // namespace jaxmpm
