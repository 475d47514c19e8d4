#pragma once
// Values over space: a number, an expression or a neural network, as the deck gives one component of a velocity.
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "deck/deck.hpp"

namespace jaxmpm {

class Field {
 public:
  virtual ~Field() = default;
  /// Value at a place in deck coordinates (m); the third coordinate is not read in 2D.
  virtual double value(const std::array<double, 3>& place) const = 0;
};

/// Builds one component. `dim` decides which of x, y, z exist; `parameters` are the deck's; `pointer` is the component's JSON pointer, e.g.
/// /bodies/0/velocity/0. Throws DeckError for unknown names and malformed expressions.
std::unique_ptr<Field> make_field(const deck::Component& component, int dim, const std::map<std::string, double>& parameters,
                                  const std::string& pointer);

/// Index of the coordinate called x, y or z in a space of `dim` dimensions; −1 where there is none.
int coordinate_index(const std::string& name, int dim);

}  // namespace jaxmpm
