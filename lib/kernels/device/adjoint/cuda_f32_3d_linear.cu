#include "kernels/device/adjoint/scheme_impl.hpp"

namespace jaxmpm {
template DeviceAdjoint<float, 3, Kokkos::Cuda> device_adjoint<float, 3, 2, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
