#include "kernels/device/scheme_impl.hpp"

namespace jaxmpm {
template DeviceScheme<double, 2, Kokkos::Cuda> device_scheme<double, 2, 3, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
