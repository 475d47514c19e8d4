#pragma once
// The steppers on the GPU; only in builds whose Kokkos has CUDA.
#include "solvers/reversible.hpp"

namespace jaxmpm {

/// The steppers of a model on the GPU that Kokkos has chosen.
std::unique_ptr<Solver> make_cuda_solver(const Model& model);
std::unique_ptr<ReversibleSolver> make_cuda_reversible_solver(const Model& model);
std::shared_ptr<StateMemory> make_cuda_state_memory();

}  // namespace jaxmpm
