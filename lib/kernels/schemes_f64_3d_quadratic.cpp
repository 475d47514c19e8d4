#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<double, 3> step_kernels<double, 3, 3>(const deck::Method&);
}
