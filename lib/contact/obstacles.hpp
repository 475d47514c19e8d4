#pragma once
// Rigid obstacles on the grid: predictor–corrector contact at nodes inside a solid, with normals from its signed distance (Eqs 33, 35, 36).
#include <cmath>
#include <cstdint>

#include "core/scalar.hpp"
#include "core/tensor.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// Nodes within this distance of the surface count as inside (cells): a face that lies on lattice planes stops the material there.
inline constexpr double obstacle_tolerance = 1e-9;

/// An obstacle's surface as a lattice node feels it. Behind a face of the domain the solid goes on as its mirror image, so the normal of a
/// node on the face lies in the face (zero where nothing is left of it): else a slope would push the material out of the domain.
inline SignedDistance surface_at_node(const RigidObstacle& obstacle, const Point& node, const Model& model) {
  SignedDistance surface = obstacle.signed_distance(node);
  bool on_face = false;
  double square = 0;
  const auto dim = std::size_t(model.dim);
  for (std::size_t d = 0; d < dim; ++d) {
    const bool low = node[d] == 0, high = node[d] == model.cells[d];
    if ((low || high) && !model.is_periodic(int(d)) && !model.is_open(int(d), high)) on_face = true, surface.normal[d] = 0;
    square += surface.normal[d] * surface.normal[d];
  }
  constexpr double nothing = 1e-12;
  for (std::size_t d = 0; on_face && d < dim; ++d) surface.normal[d] = square > nothing ? surface.normal[d] / std::sqrt(square) : 0;
  return surface;
}

/// A node inside an obstacle.
template <class T, int Dim>
struct ObstacleNode {
  std::uint32_t node;      // own node of its block
  std::uint32_t obstacle;  // in deck order
  Vector<T, Dim> normal;   // out of the solid
};

/// What an obstacle did at one node: impulse on the material, N s, and energy lost to friction, J.
template <class T, int Dim>
struct ObstacleContact {
  Vector<T, Dim> impulse;
  T friction_work;
};

/// Applies one obstacle to the velocity of a node of mass m.
template <class T, int Dim>
JAXMPM_INLINE ObstacleContact<T, Dim> apply_obstacle(deck::ContactKind kind, T friction, const Vector<T, Dim>& normal, T mass,
                                                     Vector<T, Dim>& v) {
  using Kind = deck::ContactKind;
  ObstacleContact<T, Dim> done{};
  const Vector<T, Dim> before = v;
  T vn = 0;
  for (int c = 0; c < Dim; ++c) vn += v[c] * normal[c];
  if ((kind == Kind::separate || kind == Kind::friction) && !(vn < 0)) return done;
  for (int c = 0; c < Dim; ++c) v[c] -= vn * normal[c];
  if (kind == Kind::no_slip) v = {};
  if (kind == Kind::friction) {
    T square = 0;
    for (int c = 0; c < Dim; ++c) square += v[c] * v[c];
    if (square > 0) {
      const T scale = max(T(0), T(1) - friction * -vn / sqrt(square));
      for (int c = 0; c < Dim; ++c) v[c] *= scale;
      done.friction_work = T(0.5) * mass * square * (T(1) - scale * scale);
    }
  }
  for (int c = 0; c < Dim; ++c) done.impulse[c] = mass * (v[c] - before[c]);
  return done;
}

}  // namespace jaxmpm
