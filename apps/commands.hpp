#pragma once
// The subcommands; each lives in the file of its name and returns its exit code. What they take from the command line are plain structs.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// What every subcommand understands.
struct CommonOptions {
  bool quiet = false, verbose = false;
  std::string log;
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

struct BenchOptions : DeckOptions {
  std::uint64_t steps = 0, warm_up = 5;
  bool json = false, gradient = false;
};

struct GradientOptions : DeckOptions {
  bool check = false, json = false;
  std::size_t directions = 5;
  std::uint64_t seed = 1;
};

/// The deck as the command line asks for it, with its results directory.
deck::Deck read(const ResultsOptions& options);
/// The backend asked for, or the best one of this build.
Backend chosen_backend(const DeckOptions& options);

int run(const ResultsOptions& options, bool quiet);
int invert(const ResultsOptions& options);
int check(const DeckOptions& options);
int gradient(const GradientOptions& options);
int bench(const BenchOptions& options);
int schema(bool markdown);
int info();

}  // namespace jaxmpm
