#pragma once
// The subcommands; each lives in the file of its name. They add themselves to the command line and return their exit code when chosen.
#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/logging.hpp"
#include "deck/deck.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// What every subcommand understands.
struct CommonOptions {
  bool quiet = false, verbose = false;
  std::string log;
  Verbosity verbosity() const { return quiet ? Verbosity::quiet : verbose ? Verbosity::verbose : Verbosity::normal; }
};

/// A deck and how to run it.
struct DeckOptions {
  std::string deck;
  std::vector<std::string> assignments;  // --set
  std::optional<int> threads;
  std::optional<std::string> backend;
};

/// A deck whose command writes a results directory, and can be stopped and resumed.
struct ResultsOptions : DeckOptions {
  std::optional<std::string> directory, resume;
  bool overwrite = false;
  double max_walltime = 0;  // min
};
/// The deck as the command line asks for it, with its results directory.
deck::Deck read(const ResultsOptions& options);

/// Work of the subcommand that was chosen on the command line; its result is the exit code.
using Chosen = std::function<int(const CommonOptions&)>;

void add_common_options(CLI::App& app, CommonOptions& options);
void add_deck_options(CLI::App& app, DeckOptions& options);
/// For commands that run on any backend; gradients are computed on the CPU.
void add_backend_option(CLI::App& app, DeckOptions& options);
/// The backend asked for, or the best one of this build.
Backend chosen_backend(const DeckOptions& options);

void add_run(CLI::App& app, Chosen& chosen);
void add_check(CLI::App& app, Chosen& chosen);
void add_bench(CLI::App& app, Chosen& chosen);
void add_invert(CLI::App& app, Chosen& chosen);
void add_gradient(CLI::App& app, Chosen& chosen);
void add_schema(CLI::App& app, Chosen& chosen);
void add_info(CLI::App& app, Chosen& chosen);

}  // namespace jaxmpm
