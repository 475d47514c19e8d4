#include <algorithm>
#include <cmath>
#include <set>

#include "deck/check.hpp"
#include "deck/descriptions.hpp"

namespace jaxmpm::deck {

using described::join;
using described::Place;
using described::shown_number;

void check_reference(const std::string& name, const std::vector<std::string>& names, const std::string& what, const Place& place) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  const std::string choices = names.empty() ? "; the deck has none: add it" : "; choose one of: " + described::listed(names);
  place.problem("there is no " + what + " \"" + name + "\"" + described::suggestion(name, names) + choices);
}

std::size_t up_axis(const Numbers& gravity) {
  std::size_t up = gravity.size() - 1;
  for (std::size_t d = 0; d < gravity.size(); ++d)
    if (std::abs(gravity[d]) > std::abs(gravity[up])) up = d;
  return up;
}

bool along_an_axis(const Numbers& gravity) {
  return std::count_if(gravity.begin(), gravity.end(), [](double g) { return g != 0; }) == 1;
}

namespace {

/// Whether a value is there and was read without a problem.
bool sound(const Place& root, const std::string& pointer) {
  return root.value.contains(described::Json::json_pointer(pointer)) && !root.reader.troubled(pointer);
}

std::string item(const std::string& list, std::size_t index) { return join("/" + list, std::to_string(index)); }

void check_unique(const std::vector<std::string>& names, const std::string& list, const Place& root) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto first = std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) - names.begin();
    const std::string pointer = join(item(list, i), "name");
    if (static_cast<std::size_t>(first) < i && sound(root, pointer))
      root.reader.problem(
          pointer, "\"" + names[i] + "\" is the name of " + item(list, static_cast<std::size_t>(first)) + " already; choose another");
  }
}

void check_materials(const Deck& deck, const Place& root) {
  std::set<std::string> used;
  bool all_found = !deck.bodies.empty();
  for (std::size_t i = 0; i < deck.bodies.size(); ++i) {
    const std::string pointer = join(item("bodies", i), "material");
    if (sound(root, pointer))
      check_reference(deck.bodies[i].material, names_in(deck.materials), "material", root.key("bodies").item(i).key("material"));
    all_found = all_found && sound(root, pointer);
    used.insert(deck.bodies[i].material);
  }
  for (const auto& [name, material] : deck.materials)
    if (all_found && used.count(name) == 0)
      root.reader.problem(join("/materials", name), "no body uses this material; give it to one or remove it");
}

void check_initial_stress(const Deck& deck, const Place& root) {
  using Kind = InitialStress::Kind;
  for (std::size_t i = 0; i < deck.bodies.size(); ++i) {
    const Body& body = deck.bodies[i];
    const std::string pointer = join(item("bodies", i), "initial_stress");
    if (body.initial_stress.kind == Kind::none || !sound(root, pointer) || !sound(root, "/gravity")) continue;
    if (std::all_of(deck.gravity.begin(), deck.gravity.end(), [](double g) { return g == 0; }))
      root.reader.problem(pointer, "has no effect without gravity; remove it");
    else if (!along_an_axis(deck.gravity) && !body.initial_stress.surface)
      root.reader.problem(pointer, "needs surface {point}: gravity is along no axis");
    const auto material = deck.materials.find(body.material);
    if (body.initial_stress.kind != Kind::hydrostatic && material != deck.materials.end() &&
        std::holds_alternative<Newtonian>(material->second))
      root.reader.problem(pointer, "a fluid bears no geostatic stress; choose \"hydrostatic\" or \"none\"");
  }
}

/// Points have no inside: they can be a body, but no part of another shape and no obstacle.
void check_points_in(const Shape& shape, const Place& place, bool whole) {
  if (std::holds_alternative<Points>(shape.kind) && !whole)
    place.key("points").problem("points have no inside: they can be the whole shape of a body only; choose another shape");
  const auto parts = [&](const std::vector<Shape>& shapes, const char* key) {
    for (std::size_t i = 0; i < shapes.size(); ++i) check_points_in(shapes[i], place.key(key).item(i), false);
  };
  if (const auto* all = std::get_if<Union>(&shape.kind)) parts(all->shapes, "union");
  if (const auto* both = std::get_if<Difference>(&shape.kind)) parts(both->shapes, "difference");
}

void check_points(const Deck& deck, const Place& root) {
  for (std::size_t i = 0; i < deck.bodies.size(); ++i)
    if (sound(root, join(item("bodies", i), "shape"))) check_points_in(deck.bodies[i].shape, root.key("bodies").item(i).key("shape"), true);
  for (std::size_t i = 0; i < deck.obstacles.size(); ++i)
    if (sound(root, join(item("obstacles", i), "shape")))
      check_points_in(deck.obstacles[i].shape, root.key("obstacles").item(i).key("shape"), false);
  const bool points = std::any_of(deck.bodies.begin(), deck.bodies.end(), [](const Body& body) { return body.by_points(); });
  for (std::size_t i = 0; i < deck.bodies.size() && points; ++i) {
    const InitialStress& stress = deck.bodies[i].initial_stress;
    const std::string pointer = join(item("bodies", i), "initial_stress");
    if (stress.kind != InitialStress::Kind::none && !stress.surface && sound(root, pointer))
      root.reader.problem(pointer, "needs surface {point}: depth is measured along lines of a lattice, which points of a file do not form");
  }
}

std::set<std::string> identifiers(const std::string& expression) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < expression.size();) {
    const auto part = [&](std::size_t at) {
      return at < expression.size() && (std::isalnum(static_cast<unsigned char>(expression[at])) || expression[at] == '_');
    };
    std::size_t end = i;
    while (part(end)) ++end;
    if (end > i && !std::isdigit(static_cast<unsigned char>(expression[i]))) names.insert(expression.substr(i, end - i));
    i = std::max(end, i + 1);
  }
  return names;
}

void check_parameters(const Deck& deck, const Place& root) {
  std::set<std::string> used;
  for (const Formula& component : deck.body_force)
    if (const auto* text = std::get_if<std::string>(&component)) used.merge(identifiers(*text));
  for (const Body& body : deck.bodies)
    if (const auto* components = std::get_if<std::vector<Component>>(&body.velocity))
      for (const Component& component : *components)
        if (const auto* text = std::get_if<std::string>(&component)) used.merge(identifiers(*text));
  for (const auto& [name, value] : deck.parameters) {
    const std::string pointer = join("/parameters", name);
    if (name == "x" || name == "y" || name == "z") root.reader.problem(pointer, "is the name of a coordinate; choose another");
    else if (name.find_first_of(".-") != std::string::npos)
      root.reader.problem(pointer, "a parameter's name has only letters, digits and _");
    else if (used.count(name) == 0 && sound(root, "/bodies")) root.reader.problem(pointer, "no expression uses this parameter; remove it");
  }
}

/// A wall's segments run along the first axis other than its own, from the domain's min to its max.
void check_segments(const Deck& deck, const std::string& face, const Wall& wall, const Place& root) {
  const std::string pointer = join("/walls", face);
  if (wall.segments.empty() || !sound(root, pointer) || !sound(root, "/domain")) return;
  const std::size_t axis = face[0] == 'x' ? 1 : 0, last = wall.segments.size() - 1;
  const double min = deck.domain.min[axis], max = deck.domain.max[axis], tolerance = 1e-6 * deck.domain.cell_size;
  const Place list = root.key("walls").key(face).key("segments");
  const std::string along = std::string(1, "xyz"[axis]);
  if (wall.segments[0].to <= min) list.item(0).problem("to", "must be above the domain's min along " + along + ", " + shown_number(min));
  if (std::fabs(wall.segments[last].to - max) > tolerance)
    list.item(last).problem("to", "the last segment must end at the domain's max along " + along + ", " + shown_number(max) + ", found " +
                                      shown_number(wall.segments[last].to));
}

/// Periodic faces come in pairs, with whole blocks of the grid between them.
void check_periodic(const Deck& deck, const std::string& face, const Place& root) {
  const bool is_min = face.substr(1) == "_min";
  const std::string opposite = face.substr(0, 1) + (is_min ? "_max" : "_min"), pointer = join(join("/walls", face), "kind");
  const auto other = deck.walls.find(opposite);
  if (other == deck.walls.end() || other->second.kind != ContactKind::periodic)
    return root.reader.problem(pointer, "the opposite face " + opposite + " has to be periodic too");
  const std::size_t axis = std::size_t(face[0] - 'x');
  if (!is_min || !sound(root, "/domain")) return;
  const long block = root.reader.dimension() == 2 ? 8 : 4,
             cells = std::lround((deck.domain.max[axis] - deck.domain.min[axis]) / deck.domain.cell_size);
  if (cells % block != 0)
    root.reader.problem(pointer, "the domain is " + std::to_string(cells) + " cells wide along " + face[0] +
                                     "; between periodic faces it has to be a multiple of " + std::to_string(block) +
                                     " (a block of the grid): " + std::to_string(std::max(block, cells / block * block)) + " or " +
                                     std::to_string((cells / block + 1) * block));
}

void check_wall_velocity(const std::string& face, const Wall& wall, const Place& root) {
  const std::size_t axis = std::size_t(face[0] - 'x');
  if (axis < wall.velocity.size() && wall.velocity[axis] != 0)
    root.key("walls")
        .key(face)
        .key("velocity")
        .item(axis)
        .problem("must be 0: the faces of the domain move along themselves only, not towards the material");
}

void check_walls(const Deck& deck, const Place& root) {
  const int dimension = root.reader.dimension();
  for (const auto& [face, wall] : deck.walls) {
    if (dimension == 2 && face[0] == 'z')
      root.reader.problem(join("/walls", face), "a 2D domain has no such face; choose one of: " + described::listed(face_names(2)));
    else if (root.given("walls")) {
      check_segments(deck, face, wall, root), check_wall_velocity(face, wall, root);
      if (wall.kind == ContactKind::periodic) check_periodic(deck, face, root);
    }
  }
}

/// Material that a wall carries more slowly than the threshold would be stopped.
void check_rest(const Deck& deck, const Place& root) {
  if (!deck.method.rest) return;
  for (const auto& [face, wall] : deck.walls) {
    double square = 0;
    for (const double component : wall.velocity) square += component * component;
    if (square > 0 && std::sqrt(square) <= deck.method.rest->speed)
      root.reader.problem("/method/rest/speed", "is above that of the wall " + face + ", " + shown_number(std::sqrt(square)) +
                                                    " m/s: what the wall carries would be stopped; take less than that");
  }
}

void check_body_force(const Deck& deck, const Place& root) {
  if (deck.body_force.empty()) return;
  if (deck.method.rest) root.reader.problem("/method/rest", "a body force may move what is at rest at any time; remove one of the two");
  if (deck.parameters.count("t") > 0) root.reader.problem("/parameters/t", "is the time in /body_force; choose another name");
}

}  // namespace

void check_scene(const Deck& deck, const Place& root) {
  check_unique(names_in(deck.bodies), "bodies", root);
  check_unique(names_in(deck.obstacles), "obstacles", root);
  check_materials(deck, root);
  check_initial_stress(deck, root);
  check_points(deck, root);
  check_parameters(deck, root);
  check_walls(deck, root);
  check_rest(deck, root);
  check_body_force(deck, root);
}

}  // namespace jaxmpm::deck
