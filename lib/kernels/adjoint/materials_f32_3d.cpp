#include "kernels/adjoint/material_adjoint_impl.hpp"

namespace jaxmpm {
template std::unique_ptr<MaterialAdjoint<float, 3>> make_material_adjoint(const deck::Material&);
}  // namespace jaxmpm
