#include "kernels/device/adjoint/scheme_impl.hpp"

namespace jaxmpm {
template DeviceAdjoint<double, 3, Kokkos::Cuda> device_adjoint<double, 3, 4, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
