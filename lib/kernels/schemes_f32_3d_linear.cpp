#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<float, 3> step_kernels<float, 3, 2>(const deck::Method&);
}
