// Options that subcommands share.
#include <nlohmann/json.hpp>

#include "commands.hpp"

namespace jaxmpm {

void add_common_options(CLI::App& app, CommonOptions& options) {
  CLI::Option* quiet = app.add_flag("-q,--quiet", options.quiet, "Warnings and errors only");
  app.add_flag("-v,--verbose", options.verbose, "Tell more, such as each frame written")->excludes(quiet);
  app.add_option("--log", options.log, "Write everything that is told to this file too, with time stamps")->type_name("FILE");
}

void add_deck_options(CLI::App& app, DeckOptions& options) {
  app.add_option("deck", options.deck, "The deck: a JSON file (docs/deck.md)")->required()->type_name("DECK");
  app.add_option("--set", options.assignments, "Set a value of the deck, e.g. --set /time/end=0.5; may be repeated")
      ->type_name("POINTER=JSON")
      ->allow_extra_args(false);
  app.add_option("--threads", options.threads, "Host threads; default: all cores")->check(CLI::Range(1, 4096))->type_name("N");
}

void add_backend_option(CLI::App& app, DeckOptions& options) {
  app.add_option("--backend", options.backend, "cpu or cuda; default: cuda where the program was built for it")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->type_name("NAME");
}

Backend chosen_backend(const DeckOptions& options) {
  if (options.backend) return *options.backend == "cuda" ? Backend::cuda : Backend::cpu;
  return has_backend(Backend::cuda) ? Backend::cuda : Backend::cpu;
}

deck::Deck read(const ResultsOptions& options) {
  std::vector<std::string> assignments = options.assignments;
  if (options.directory) assignments.push_back("/output/directory=" + nlohmann::json(*options.directory).dump());
  return deck::read_deck(options.deck, assignments);
}

}  // namespace jaxmpm
