// What subcommands do with options that they share.
#include <nlohmann/json.hpp>

#include "commands.hpp"

namespace jaxmpm {

Backend chosen_backend(const DeckOptions& options) {
  if (options.backend) return *options.backend == "cuda" ? Backend::cuda : Backend::cpu;
  return has_backend(Backend::cuda) ? Backend::cuda : Backend::cpu;
}

deck::Deck read(const ResultsOptions& options) {
  std::vector<std::string> assignments = options.assignments;
  if (options.directory) assignments.push_back("/output/directory=" + nlohmann::ordered_json(*options.directory).dump());
  return deck::read_deck(options.deck, assignments);
}

}  // namespace jaxmpm
