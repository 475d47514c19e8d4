#include "kernels/step_kernels_impl.hpp"

namespace jaxmpm {
template StepKernels<float, 2> step_kernels<float, 2, 2>(const deck::Method&);
}
