#include "kernels/adjoint/step_adjoint_impl.hpp"

namespace jaxmpm {
template AdjointKernels<float, 2> adjoint_kernels<float, 2, 2>(const deck::Method&);
}  // namespace jaxmpm
