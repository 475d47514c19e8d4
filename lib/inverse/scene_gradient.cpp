#include "inverse/scene_gradient.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "deck/inverse.hpp"
#include "fields/body_force.hpp"
#include "materials/constants.hpp"
#include "scene/initial_gradient.hpp"

namespace jaxmpm {
namespace {

using Parts = std::vector<std::string>;

/// The keys and indices of a JSON pointer.
Parts parts_of(const std::string& pointer) {
  Parts parts;
  for (nlohmann::ordered_json::json_pointer rest(pointer); !rest.empty(); rest.pop_back()) parts.push_back(rest.back());
  std::reverse(parts.begin(), parts.end());
  return parts;
}

class SceneGradient {
 public:
  SceneGradient(const deck::Deck& deck, const Model& model, const ModelGradient& gradient)
      : deck_(deck), gradient_(gradient), body_force_(model.body_force.get()), initial_(deck, model, initial_states(gradient)) {}

  std::vector<double> by(const std::string& pointer) const {
    const Parts parts = parts_of(pointer);
    try {
      if (parts.at(0) == "gravity") return {by_gravity(std::stoul(parts.at(1)))};
      if (parts[0] == "method" && parts.at(1) == "flip_fraction") return {gradient_.flip_fraction};
      if (parts[0] == "method" && parts.at(1) == "damping") return {by_damping(pointer)};
      if (parts[0] == "body_force") return {by_body_force(std::stoul(parts.at(1)), pointer)};
      if (parts[0] == "parameters") return {by_parameter(parts.at(1))};
      if (parts[0] == "materials") return {by_material(parts.at(1), parts.at(2), pointer)};
      if (parts[0] == "bodies") return by_body(std::stoul(parts.at(1)), parts, pointer);
      if (parts[0] == "walls") return {by_wall(parts)};
      if (parts[0] == "obstacles" && parts.at(2) == "coefficient") return {gradient_.obstacle_coefficient.at(std::stoul(parts[1]))};
    } catch (const std::out_of_range&) {
      // a pointer too short or to nothing: refused below
    }
    refuse(pointer);
  }

 private:
  static std::vector<const BodyState*> initial_states(const ModelGradient& gradient) {
    std::vector<const BodyState*> states;
    for (const BodyGradient& body : gradient.bodies) states.push_back(&body.initial);
    return states;
  }
  [[noreturn]] static void refuse(const std::string& pointer) {
    throw DeckError(pointer,
                    "is no number of the step or of the initial fields, so the loss has no derivative by it; choose another unknown");
  }

  double by_gravity(std::size_t axis) const { return gradient_.gravity.at(axis) + initial_.by_weight(deck_.gravity.at(axis)); }

  double by_damping(const std::string& pointer) const {
    if (deck_.method.damping > 0) return gradient_.damping;
    throw DeckError(pointer, "is 0: the run is then without damping, and has no derivative by it; start above 0");
  }
  double by_body_force(std::size_t axis, const std::string& pointer) const {
    if (!std::holds_alternative<double>(deck_.body_force.at(axis))) refuse(pointer);
    return gradient_.body_force.at(axis);
  }
  double by_parameter(const std::string& name) const {
    const double by_initial = initial_.by_parameter(name);
    if (!body_force_) return by_initial;
    const Parts& names = body_force_->parameters();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return by_initial;
    for (std::size_t axis = 0; axis < deck_.body_force.size(); ++axis) body_force_->slope_text(axis, name);  // throws where there is none
    return by_initial + gradient_.body_force.at(3 + static_cast<std::size_t>(found - names.begin()));
  }
  double by_material(const std::string& name, const std::string& key, const std::string& pointer) const {
    const deck::Material& material = deck_.materials.at(name);
    const MaterialNumbers numbers = std::visit([](const auto& m) { return material_numbers(m); }, material);
    const auto number = std::find_if(numbers.begin(), numbers.end(), [&](const auto& entry) { return entry.first == key; });
    if (number == numbers.end()) refuse(pointer);
    if (key == "viscosity" && *number->second == 0)
      throw DeckError(pointer,
                      "is 0: the fluid is then run without viscous stress, which has no derivative by it; start above 0, and keep it "
                      "there by bounds or transform \"log\"");
    double sum = initial_.by_weight(*number->second);
    for (std::size_t b = 0; b < deck_.bodies.size(); ++b)
      if (deck_.bodies[b].material == name) sum += gradient_.bodies[b].material.at(key);
    return sum;
  }

  std::vector<double> by_body(std::size_t body, const Parts& parts, const std::string& pointer) const {
    const deck::Body& wanted = deck_.bodies.at(body);
    const bool velocity = parts.at(2) == "velocity", by_file = std::holds_alternative<deck::ParticleFile>(wanted.velocity);
    if (deck::is_particle_velocities(pointer) && by_file) return initial_.by_particle_velocities(body);
    if (velocity && parts.size() > 3 && parts[3] != "particles" && !by_file) return by_component(body, parts, pointer);
    if (parts.at(2) == "initial_stress" && parts.at(3) == "k0") return {initial_.by_weight(wanted.initial_stress.k0)};
    refuse(pointer);
  }
  std::vector<double> by_component(std::size_t body, const Parts& parts, const std::string& pointer) const {
    const std::size_t axis = std::stoul(parts[3]);
    const deck::Component& component = std::get<std::vector<deck::Component>>(deck_.bodies[body].velocity).at(axis);
    const bool number = std::holds_alternative<double>(component) && parts.size() == 4;
    const bool network = std::holds_alternative<deck::Mlp>(component) && parts.size() == 5 && parts[4] == "mlp";
    if (!number && !network) refuse(pointer);
    return initial_.by_velocity(body, static_cast<int>(axis));
  }

  double by_wall(const Parts& parts) const {
    const std::vector<std::string> faces = deck::face_names(3);
    const auto face = static_cast<std::size_t>(std::find(faces.begin(), faces.end(), parts.at(1)) - faces.begin());
    const std::vector<double>& by_segments = gradient_.coefficient.at(face);
    if (parts.at(2) == "velocity") return gradient_.wall_velocity.at(face).at(std::stoul(parts.at(3)));
    if (parts.at(2) == "coefficient") return by_segments.at(0);
    return by_segments.at(std::stoul(parts.at(3)));
  }

  const deck::Deck& deck_;
  const ModelGradient& gradient_;
  const BodyForce* body_force_;  // null where the deck has none
  InitialGradient initial_;
};

}  // namespace

std::map<std::string, std::vector<double>> gradient_by_pointer(const deck::Deck& deck, const Model& model, const ModelGradient& gradient,
                                                               const std::vector<std::string>& pointers) {
  const SceneGradient scene(deck, model, gradient);
  std::map<std::string, std::vector<double>> by;
  for (const std::string& pointer : pointers) by[pointer] = scene.by(pointer);
  return by;
}

}  // namespace jaxmpm
