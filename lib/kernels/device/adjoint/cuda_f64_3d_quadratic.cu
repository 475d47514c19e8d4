#include "kernels/device/adjoint/scheme_impl.hpp"

namespace jaxmpm {
template DeviceAdjoint<double, 3, Kokkos::Cuda> device_adjoint<double, 3, 3, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
