// jaxmpm schema: the deck's JSON Schema, or its reference page.
#include <iostream>

#include "commands.hpp"

namespace jaxmpm {

int schema(bool markdown) {
  std::cout << (markdown ? deck::reference_page() : deck::schema()) << '\n';
  return 0;
}

}  // namespace jaxmpm
