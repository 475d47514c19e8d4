#include "scene/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "fields/body_force.hpp"
#include "scene/holding_normals.hpp"
#include "scene/initial_stress.hpp"
#include "scene/initial_velocity.hpp"
#include "scene/overburden.hpp"
#include "scene/seeding.hpp"

namespace jaxmpm {
namespace {

constexpr double kContactReach = 1;  // cells: may_touch tells of boxes that can hold places nearer to the solid than this

std::array<FaceLaw, 6> make_faces(const deck::Deck& deck, const Frame& frame) {
  std::array<FaceLaw, 6> faces;
  const std::vector<std::string> names = deck::face_names(3);
  for (std::size_t face = 0; face < names.size(); ++face) {
    FaceLaw& law = faces[face];
    law.segment_axis = face / 2 == 0 ? 1 : 0;  // the first other axis
    const auto wall = deck.walls.find(names[face]);
    if (wall == deck.walls.end()) continue;
    law.kind = wall->second.kind;
    std::copy(wall->second.velocity.begin(), wall->second.velocity.end(), law.velocity.begin());
    if (law.kind != deck::ContactKind::friction) continue;
    for (const deck::Segment& segment : wall->second.segments) {
      law.to.push_back(frame.coordinate(segment.to, law.segment_axis));
      law.coefficient.push_back(segment.coefficient);
    }
    if (law.coefficient.empty()) law.coefficient.push_back(wall->second.coefficient);
  }
  return faces;
}

RigidObstacle make_obstacle(const deck::Obstacle& obstacle, const GeometryPointer& shape) {
  RigidObstacle made;
  made.name = obstacle.name;
  made.kind = obstacle.kind;
  made.coefficient = obstacle.coefficient;
  made.signed_distance = [shape](const Point& place) { return shape->signed_distance(place); };
  made.may_touch = [shape](const Point& lower, const Point& upper) { return shape->may_reach(lower, upper, kContactReach); };
  return made;
}

/// Whether a node of the grid lies in an obstacle; taken for granted where that would take long to find out.
bool holds_a_node(const Geometry& shape, const Frame& frame) {
  constexpr double many = 2e6, on_surface = obstacle_tolerance;  // nodes; cells
  const Bounds bounds = shape.bounds();
  std::array<int, 3> first{}, last{};
  double count = 1;
  for (int d = 0; d < frame.dim; ++d) {
    first[d] = static_cast<int>(std::ceil(std::max(0.0, bounds.lower[d] - on_surface)));
    last[d] = static_cast<int>(std::floor(std::min<double>(frame.cells[d], bounds.upper[d] + on_surface)));
    count *= std::max(0, last[d] - first[d] + 1);
  }
  if (count > many) return true;
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int k = first[2]; k <= last[2]; ++k)
        if (shape.signed_distance({double(i), double(j), double(k)}).distance <= on_surface) return true;
  return false;
}

const deck::Material& material_of(const deck::Deck& deck, std::size_t body) {
  const auto material = deck.materials.find(deck.bodies[body].material);
  if (material == deck.materials.end())
    throw DeckError("/bodies/" + std::to_string(body) + "/material", "there is no material '" + deck.bodies[body].material + "'");
  return material->second;
}

/// Mass of a particle's volume (of the lattice, or by its file) at its density.
void set_masses(Body& body, const Seeds& seeds, const Frame& frame) {
  const double density = deck::reference_density(body.material);
  for (std::size_t p = 0; p < body.initial.mass.size(); ++p)
    body.initial.mass[p] = density * seeds.volume(p, frame) * (1 + body.initial.compression[p]);
}

std::vector<Body> place_bodies(const deck::Deck& deck, const Frame& frame, const SeededScene& scene,
                               const std::vector<GeometryPointer>& obstacles) {
  std::uint64_t total = 0;
  for (const Seeds& seeds : scene.seeds) total += seeds.count;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw DeckError("/bodies",
                    "the scene has " + std::to_string(total) + " particles, more than ids can number (4294967295); use a coarser lattice");
  std::vector<Body> bodies;
  std::uint32_t first_id = 0;
  for (std::size_t i = 0; i < deck.bodies.size(); ++i) {
    Body body{deck.bodies[i].name, material_of(deck, i), {}};
    const std::size_t count = scene.seeds[i].count;
    BodyState& state = body.initial;
    state.position = seed_positions(deck.bodies[i], frame, *scene.shapes[i], scene.seeds[i], obstacles, first_id);
    state.id.resize(count);
    for (std::size_t p = 0; p < count; ++p) state.id[p] = first_id + static_cast<std::uint32_t>(p);
    first_id += static_cast<std::uint32_t>(count);
    state.velocity.assign(count, Point{});
    state.compression.assign(count, 0.0);
    state.mass.resize(count);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<std::string> notices_of(const deck::Deck& deck, const Frame& frame, const std::vector<GeometryPointer>& obstacles,
                                    const std::vector<Seeds>& seeds, const std::vector<double>& gaps) {
  std::vector<std::string> notices;
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    if (!holds_a_node(*obstacles[i], frame))
      notices.push_back("obstacle '" + deck.obstacles[i].name +
                        "' holds no node of the grid, so nothing will touch it: it is thinner than a cell or lies outside of the domain");
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (seeds[i].cut > 0)
      notices.push_back("body '" + deck.bodies[i].name + "': " + std::to_string(seeds[i].cut) + " of its " +
                        std::to_string(seeds[i].cut + seeds[i].count) + " particles lie inside an obstacle and are left out");
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (gaps[i] >= 1)
      notices.push_back(
          "body '" + deck.bodies[i].name + "': its initial_stress counts a gap of " + number_text(gaps[i] * frame.cell_size) +
          " m in the material above as filled, as where an obstacle stands in a pool; if what is above the gap is to fall, give "
          "\"surface\": { \"point\": […] } on the free surface below it");
  return notices;
}

/// The deck's body force, which has to be a number wherever there is material at the start.
std::shared_ptr<const BodyForce> make_body_force(const deck::Deck& deck, const Frame& frame, const std::vector<Body>& bodies) {
  if (deck.body_force.empty()) return nullptr;
  auto force = std::make_shared<const BodyForce>(deck.body_force, frame.dim, deck.parameters);
  const BodyForce::Loan field(*force);
  for (const Body& body : bodies)
    for (const Point& place : body.initial.position) {
      const Point b = field.at(frame.metres(place), 0);
      for (int d = 0; d < frame.dim; ++d)
        if (!std::isfinite(b[std::size_t(d)]))
          throw DeckError("/body_force/" + std::to_string(d), "the force at " + frame.text(place) +
                                                                  " at the start is not a finite number; make the expression hold wherever "
                                                                  "the material may come");
    }
  return force;
}

bool names_velocity_gradient(const std::vector<std::string>& fields) {
  return std::find(fields.begin(), fields.end(), "velocity_gradient") != fields.end();
}

bool asks_for_velocity_gradient(const deck::Deck& deck) {
  if (deck.output.fields && names_velocity_gradient(*deck.output.fields)) return true;
  return std::any_of(deck.gauges.begin(), deck.gauges.end(), [](const auto& entry) {
    if (const auto* mean = std::get_if<deck::RegionMeanGauge>(&entry.second)) return mean->field == "velocity_gradient";
    if (const auto* particles = std::get_if<deck::ParticlesGauge>(&entry.second)) return names_velocity_gradient(particles->fields);
    return false;
  });
}

bool has_energy_gauge(const deck::Deck& deck) {
  return std::any_of(deck.gauges.begin(), deck.gauges.end(),
                     [](const auto& entry) { return std::holds_alternative<deck::EnergyGauge>(entry.second); });
}

}  // namespace

Model build_model(const deck::Deck& deck) {
  const Frame frame = make_frame(deck);
  Model model;
  model.dim = frame.dim;
  model.cells = frame.cells;
  model.domain_min = frame.domain_min;
  model.cell_size = frame.cell_size;
  std::copy(deck.gravity.begin(), deck.gravity.end(), model.gravity.begin());
  model.method = deck.method;
  model.time = deck.time;
  model.faces = make_faces(deck, frame);
  const std::vector<GeometryPointer> obstacles = obstacle_shapes(deck, frame);
  for (std::size_t i = 0; i < obstacles.size(); ++i) model.obstacles.push_back(make_obstacle(deck.obstacles[i], obstacles[i]));

  const SeededScene scene = seed_bodies(deck, frame, obstacles);
  model.bodies = place_bodies(deck, frame, scene, obstacles);
  const std::vector<double> gaps = set_initial_stress(deck, frame, scene.seeds, model.bodies);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    set_masses(model.bodies[i], scene.seeds[i], frame);
    set_initial_velocity(deck, frame, i, model.bodies[i].initial);
  }
  model.body_force = make_body_force(deck, frame, model.bodies);
  model.record_velocity_gradient = asks_for_velocity_gradient(deck);
  model.account_energy = has_energy_gauge(deck);
  model.notices = notices_of(deck, frame, obstacles, scene.seeds, gaps);
  return model;
}

}  // namespace jaxmpm
