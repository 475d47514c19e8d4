#pragma once
// The lattice frame: deck coordinates (m) to cells from domain.min. The minimum is subtracted in double first, so that nothing depends on
// the distance from the deck's origin; lengths and places are then rounded to 2⁻²⁰ cell, so that a scene moved by kilometres gives the same
// bits.
#include <string>

#include "deck/deck.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

struct Frame {
  int dim = 2;
  std::array<int, 3> cells{1, 1, 1};
  Point domain_min{};
  double cell_size = 0;
  std::string folder;  // of the deck; relative file names start there

  int up() const { return dim - 1; }  // columns and height maps run along the last axis

  /// One coordinate (m) along an axis, in cells from domain.min.
  double coordinate(double metres, int axis) const;
  /// A length (m) in cells.
  double length(double metres) const;
  /// A place (m) in cells; DeckError at `pointer` unless it has one number per axis.
  Point place(const deck::Numbers& metres, const std::string& pointer) const;
  /// Deck coordinates (m) of a place in cells.
  Point metres(const Point& place) const;
  /// "(1.25, 0.4) m" for messages, from a place in cells.
  std::string text(const Point& place) const;
  /// Name of a file given in the deck, relative ones beside the deck.
  std::string file(const std::string& name) const;
};

/// Frame of a deck whose extents are whole cells (the reader has checked them).
Frame make_frame(const deck::Deck& deck);

/// A number as messages print it (9 significant digits: national grids need them).
std::string number_text(double value);

}  // namespace jaxmpm
