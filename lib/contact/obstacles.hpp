#pragma once
// Rigid obstacles on the grid: predictor–corrector contact at nodes inside a solid, with normals from its signed distance (Eqs 33, 35, 36).
#include <cmath>
#include <cstdint>

#include "core/scalar.hpp"
#include "core/tensor.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// A node inside an obstacle, and one of the surfaces that hold it.
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
