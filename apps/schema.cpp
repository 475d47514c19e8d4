// jaxmpm schema: the deck's JSON Schema, or its reference page.
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "deck/deck.hpp"

namespace jaxmpm {

void add_schema(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("schema", "Print the JSON Schema of the deck");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "Print the deck reference as Markdown instead");
  command->callback([&chosen, markdown] {
    chosen = [markdown](const CommonOptions&) {
      std::cout << (*markdown ? deck::reference_page() : deck::schema()) << '\n';
      return 0;
    };
  });
}

}  // namespace jaxmpm
