#pragma once
// What the adjoints of both transfers share: a transfer is f(X) = Σ_i [w_i A + Σ_k (d_k)_i B_k + Σ_k (g_k)_i C_k] · N_i with groups of V
// values, A, B_k, C_k of a particle and N_i of the nodes (particle to grid: the groups are the particle's and N the derivatives by the node;
// grid to particle: the other way round), so both need the same ∂f/∂X.
#include "kernels/adjoint/contract_2d.hpp"
#include "kernels/adjoint/contract_3d.hpp"

namespace jaxmpm {

/// Masses: as of Scatter.
template <class Sch, bool Masses>
using NodeContraction = std::conditional_t<Sch::Dim == 2, Contraction2d<Sch, Masses>, Contraction3d<Sch, Masses>>;

}  // namespace jaxmpm
