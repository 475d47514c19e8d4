#pragma once
// Derivatives of a loss by everything that a run starts from, in the shape of the Model (scene/model.hpp).
#include <array>
#include <map>
#include <string>
#include <vector>

#include "scene/model.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm {

/// ∂L/∂(snapshot): the numbers of a snapshot ordered by ids are replaced by derivatives of the loss by them, per unit of the field
/// (position: 1/m, …). Empty fields are zero. `pressure`, `strain_energy`, `velocity_gradient` and `id` are not used: express
/// them by mass, density and stress.
using SnapshotGradient = std::vector<BodySnapshot>;

/// ∂L/∂(one body of the model).
struct BodyGradient {
  /// By velocity (m/s), mass (kg), compression (1) and stress (Pa; always six components, shear components count both places) of each
  /// particle, in order of ids; `id` and `position` stay empty, as seeding is fixed.
  BodyState initial;
  /// By the numbers of the deck's material (density, sound_speed, friction_angle in degrees, …) with the initial fields held fixed: by key.
  std::map<std::string, double> material;
};

/// ∂L/∂(model).
struct ModelGradient {
  Point gravity{};  // per m/s²
  double flip_fraction = 0;
  double damping = 0;                              // per 1/s
  std::vector<double> body_force;                  // BodyForce::slopes()
  std::array<Point, 6> wall_velocity{};            // per m/s
  std::array<std::vector<double>, 6> coefficient;  // of the faces' segments, as FaceLaw::coefficient
  std::vector<double> obstacle_coefficient;        // in deck order
  std::vector<BodyGradient> bodies;                // in deck order
};

}  // namespace jaxmpm
