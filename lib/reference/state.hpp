#pragma once
// Particle state of the reference step: plain vectors, three components also in 2D (the third stays zero), any scalar.
#include <array>
#include <cstddef>
#include <vector>

#include "scene/model.hpp"

namespace jaxmpm {

template <class Scalar>
using Triple = std::array<Scalar, 3>;

template <class Scalar>
struct ReferenceBody {
  std::vector<Triple<Scalar>> position;                          // X, cells from domain_min
  std::vector<Triple<Scalar>> velocity;                          // m/s
  std::vector<Scalar> mass;                                      // kg
  std::vector<Scalar> compression;                               // e = ρ/ρ0 − 1
  std::vector<std::array<Triple<Scalar>, 3>> affine;             // C, 1/s: row i, column j multiplies (x_i − x_p)_j
  std::vector<std::array<Triple<Scalar>, 3>> velocity_gradient;  // ∇v that the material saw last, 1/s
  std::vector<Scalar> dilation, mean_dilation;                   // tr H of the last step, and its mean at the nodes around
  std::vector<std::vector<Scalar>> history;                      // as the body's law keeps it
};

/// Bodies and particles in the order of model.bodies[].initial.
template <class Scalar>
struct ReferenceState {
  std::vector<ReferenceBody<Scalar>> bodies;
};

/// The first state of a model; C = 0.
template <class Scalar>
ReferenceState<Scalar> reference_state(const Model& model);

/// Cauchy stress of one particle, Pa: xx, yy, zz, xy, yz, xz.
template <class Scalar>
std::array<Scalar, 6> reference_stress(const Model& model, const ReferenceState<Scalar>& state, std::size_t body, std::size_t particle);

}  // namespace jaxmpm
