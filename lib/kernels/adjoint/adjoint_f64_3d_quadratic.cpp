#include "kernels/adjoint/step_adjoint_impl.hpp"

namespace jaxmpm {
template AdjointKernels<double, 3> adjoint_kernels<double, 3, 3>(const deck::Method&);
}  // namespace jaxmpm
