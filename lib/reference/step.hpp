#pragma once
// The step once more, plain and slow, as docs/theory.md writes it: the oracle that the fast step must match, and with dual numbers the
// source of its directional derivatives. It shares the materials and the scene with the fast step, and nothing else.
#include <map>

#include "core/dual.hpp"
#include "reference/state.hpp"

namespace jaxmpm {

using Node = std::array<int, 3>;  // lattice indices, −1 … N+1 along an axis; 0 along z in 2D

/// One node of the grid over a step.
template <class Scalar>
struct ReferenceNode {
  Scalar mass{};               // m_i, raw sum
  Triple<Scalar> momentum{};   // p_i, raw sum
  Triple<Scalar> force{};      // f_i, internal
  Triple<Scalar> predicted{};  // P_i = (p_i + Δt (f_i + m_i (gravity + body force)))/(1 + ζΔt)
  Triple<Scalar> velocity{};   // v_i after walls and obstacles
  Triple<Scalar> change{};     // Δv_i = v_i − p_i/m_i
  Scalar dilation{};           // Σ m_p φ θ_p, then its mean: the change of volume in the last step
};
template <class Scalar>
using ReferenceGrid = std::map<Node, ReferenceNode<Scalar>>;

/// What a step did besides moving the particles. The impulses of all faces and obstacles together are the momentum that the grid update
/// gave to the material beyond internal force and gravity: Σ_i (m_i v_i − P_i) over all nodes, ghosts included.
template <class Scalar>
struct ReferenceReport {
  ReferenceGrid<Scalar> grid;
  std::array<Triple<Scalar>, 6> face_impulse{};    // N s, faces as in Model::faces
  std::vector<Triple<Scalar>> obstacle_impulse{};  // N s
  Scalar plastic{}, viscous{}, friction{};         // dissipated energy, J
};

/// One explicit step of length dt from `time` on, s (Du & He 2025, Eqs 9–18). Throws NumericsError when a particle leaves the domain or is
/// not finite, and DeckError for the mls gradient with the linear basis.
template <class Scalar>
ReferenceReport<Scalar> reference_step(const Model& model, ReferenceState<Scalar>& state, const Scalar& dt, double time = 0);

/// The scalars that the library is built for.
using ReferenceDual = Dual<double, 1>;

}  // namespace jaxmpm
