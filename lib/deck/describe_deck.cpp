// The deck as a whole.
#include "deck/describe_inverse.hpp"

namespace jaxmpm::deck {
namespace {
constexpr int format = 1;
}

void describe(Description<Deck>& d) {
  d.is("deck", "A scene and what to do with it: JSON with // comments, SI units, angles in degrees.");
  d.fixed("$schema", nullptr, false, "Where an editor finds the schema.");
  d.fixed("jaxmpm", format, true, "Format of the deck, 1.");
  d.optional("title", &Deck::title).help("One line for people.");
  d.required("domain", &Deck::domain);
  d.required("gravity", &Deck::gravity).unit("m/s²").vector().help("Any axis may be up.");
  d.optional("body_force", &Deck::body_force)
      .unit("m/s²")
      .vector()
      .absent_when_empty()
      .otherwise("none")
      .help(
          "Force per unit mass besides gravity, at the nodes of the grid: per component a number or an expression of x, y, z, the time t "
          "and the deck's parameters. Only with --backend cpu.");
  d.required("time", &Deck::time);
  d.optional("method", &Deck::method).otherwise("its own defaults");
  d.optional("parameters", &Deck::parameters).help("Names for expressions; they may be unknowns of an inverse problem.");
  d.required("materials", &Deck::materials).items(1).help("By name.");
  d.required("bodies", &Deck::bodies).items(1);
  d.optional("walls", &Deck::walls).choices(face_names(3)).help("By face; a face not named is slip.");
  d.optional("obstacles", &Deck::obstacles);
  d.optional("gauges", &Deck::gauges).help("By name.");
  d.required("output", &Deck::output);
  d.optional_as<InverseText>("inverse", &Deck::inverse).otherwise("none").help("Read by invert and gradient, ignored by run.");
}

}  // namespace jaxmpm::deck
