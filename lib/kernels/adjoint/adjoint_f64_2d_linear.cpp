#include "kernels/adjoint/step_adjoint_impl.hpp"

namespace jaxmpm {
template AdjointKernels<double, 2> adjoint_kernels<double, 2, 2>(const deck::Method&);
}  // namespace jaxmpm
