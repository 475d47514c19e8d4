#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<double, 2> step_kernels<double, 2, 3>(const deck::Method&);
}
