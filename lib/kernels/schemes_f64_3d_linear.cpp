#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<double, 3> step_kernels<double, 3, 2>(const deck::Method&);
}
