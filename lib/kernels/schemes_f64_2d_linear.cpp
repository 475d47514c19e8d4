#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<double, 2> step_kernels<double, 2, 2>(const deck::Method&);
}
