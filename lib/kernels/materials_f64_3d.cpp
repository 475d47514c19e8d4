#include "kernels/material_kernel_impl.hpp"

namespace jaxmpm {
template std::unique_ptr<MaterialKernel<double, 3>> make_material_kernel(const deck::Material&);
}
