#include "kernels/device/adjoint/scheme_impl.hpp"

namespace jaxmpm {
template DeviceAdjoint<double, 2, Kokkos::Cuda> device_adjoint<double, 2, 2, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
