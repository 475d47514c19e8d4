#include "kernels/adjoint/step_adjoint_impl.hpp"

namespace jaxmpm {
template AdjointKernels<float, 3> adjoint_kernels<float, 3, 2>(const deck::Method&);
}  // namespace jaxmpm
