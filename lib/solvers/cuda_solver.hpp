#pragma once
// The stepper on the GPU; only in builds whose Kokkos has CUDA.
#include "solvers/solver.hpp"

namespace jaxmpm {

/// The stepper of a model on the GPU that Kokkos has chosen.
std::unique_ptr<Solver> make_cuda_solver(const Model& model);

}  // namespace jaxmpm
