#include "kernels/device/adjoint/scheme_impl.hpp"

namespace jaxmpm {
template DeviceAdjoint<float, 2, Kokkos::Cuda> device_adjoint<float, 2, 3, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
