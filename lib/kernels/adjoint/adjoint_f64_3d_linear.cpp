#include "kernels/adjoint/step_adjoint_impl.hpp"

namespace jaxmpm {
template AdjointKernels<double, 3> adjoint_kernels<double, 3, 2>(const deck::Method&);
}  // namespace jaxmpm
