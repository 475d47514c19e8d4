#pragma once
// Derivatives by the fields of particles on the host, as every backend starts a reverse run and ends it.
#include "kernels/adjoint/material_adjoint.hpp"
#include "solvers/model_gradient.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Zero derivatives by all fields of particles (position: per cell) that a loss can depend on; `id` stays empty.
template <class T, int Dim>
Particles<T, Dim> zero_bars(const Particles<T, Dim>& particles);

/// Derivatives by what a body's particles were started from. `first`: their first state, `bar`: derivatives by its fields; `constants`:
/// those by the law's, so far.
template <class T, int Dim>
BodyGradient body_gradient(const Body& body, const MaterialAdjoint<T, Dim>& material, const Particles<T, Dim>& first,
                           const Particles<T, Dim>& bar, MaterialReport constants);

/// Friction coefficients of all faces' segments, in the order of WallTable, by face.
std::array<std::vector<double>, 6> by_face(const Model& model, const double* segments);

}  // namespace jaxmpm
