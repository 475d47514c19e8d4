// Walls and obstacles.
#include "deck/descriptions.hpp"

namespace jaxmpm::deck {

described::EnumNames<ContactKind> names_of(ContactKind) {
  return {{ContactKind::slip, "slip"},         {ContactKind::no_slip, "no_slip"},   {ContactKind::separate, "separate"},
          {ContactKind::friction, "friction"}, {ContactKind::periodic, "periodic"}, {ContactKind::open, "open"}};
}

std::vector<std::string> face_names(int dimension) {
  std::vector<std::string> names{"x_min", "x_max", "y_min", "y_max"};
  if (dimension != 2) names.insert(names.end(), {"z_min", "z_max"});
  return names;
}

void describe(Description<Segment>& d) {
  d.is("segment", "A stretch of a wall with its own friction.");
  d.required("to", &Segment::to).unit("m").help("Where it ends: absolute coordinate along the first axis other than the wall's own.");
  d.required("coefficient", &Segment::coefficient).from(0).help("Coulomb friction μ.");
}

void describe(Description<Wall>& d) {
  d.is("wall", "Contact law of a face of the domain.");
  d.optional("kind", &Wall::kind)
      .help(
          "slip: no flow through it, both ways; no_slip: the material sticks to it; separate and friction: only where the material presses "
          "on it; periodic: what leaves here enters through the opposite face, which has to be periodic too; open: "
          "nothing is there, as at the edge of a table, and what passes it is taken out of the run.");
  d.optional("coefficient", &Wall::coefficient)
      .from(0)
      .when(
          {"kind", "segments"}, [](const Wall& wall) { return wall.kind == ContactKind::friction && wall.segments.empty(); },
          "kind \"friction\" and no segments")
      .otherwise("required unless segments are given")
      .help("Coulomb friction μ; 0 is separate.");
  d.optional("segments", &Wall::segments)
      .items(1)
      .absent_when_empty()
      .when(
          {"kind"}, [](const Wall& wall) { return wall.kind == ContactKind::friction; }, "kind \"friction\"")
      .otherwise("one coefficient for the whole wall")
      .help("Friction by stretches, in increasing order; the last ends at the domain's maximum.");
  d.optional("velocity", &Wall::velocity)
      .unit("m/s")
      .vector()
      .absent_when_empty()
      .when(
          {"kind"}, [](const Wall& wall) { return wall.kind == ContactKind::no_slip || wall.kind == ContactKind::friction; },
          "kind \"no_slip\" or \"friction\"")
      .otherwise("at rest")
      .help(
          "Of the wall along itself, as a belt runs; the domain stays where it is, so no component across it. It should not run into a "
          "face where the material sticks: what is in that corner can go nowhere and is crushed.");
  d.check({"kind"}, [](const Wall& wall, const described::Place& place) {
    if (wall.kind == ContactKind::friction && !place.given("coefficient") && !place.given("segments"))
      place.problem("coefficient", "is missing: kind \"friction\" needs it, or segments");
  });
  d.check({"segments"}, [](const Wall& wall, const described::Place& place) {
    for (std::size_t i = 1; i < wall.segments.size(); ++i)
      if (!(wall.segments[i].to > wall.segments[i - 1].to))
        place.key("segments")
            .item(i)
            .problem("to", "must be above that of the segment before, " + described::shown_number(wall.segments[i - 1].to) +
                               "; put the segments in increasing order");
  });
}

void describe(Description<Obstacle>& d) {
  d.is("obstacle",
       "A rigid solid at rest. Where it is thinner than 1.5 cells it holds the material on both its sides as slip does (docs/theory.md).");
  d.required("name", &Obstacle::name).help("Unique among obstacles.");
  d.required("shape", &Obstacle::shape);
  d.optional("kind", &Obstacle::kind).help("As for walls; neither periodic nor open.");
  d.optional("coefficient", &Obstacle::coefficient)
      .from(0)
      .when(
          {"kind"}, [](const Obstacle& obstacle) { return obstacle.kind == ContactKind::friction; }, "kind \"friction\"")
      .otherwise("required with kind \"friction\"")
      .help("Coulomb friction μ.");
  d.check({"name"},
          [](const Obstacle& obstacle, const described::Place& place) { described::check_name(obstacle.name, place.key("name")); });
  d.check({"kind"}, [](const Obstacle& obstacle, const described::Place& place) {
    if (obstacle.kind == ContactKind::periodic || obstacle.kind == ContactKind::open)
      place.problem("kind", "only faces of the domain are periodic or open; choose slip, no_slip, separate or friction");
    if (obstacle.kind == ContactKind::friction && !place.given("coefficient"))
      place.problem("coefficient", "is missing: kind \"friction\" needs it");
  });
}

}  // namespace jaxmpm::deck
