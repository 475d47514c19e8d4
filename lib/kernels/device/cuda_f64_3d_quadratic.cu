#include "kernels/device/scheme_impl.hpp"

namespace jaxmpm {
template DeviceScheme<double, 3, Kokkos::Cuda> device_scheme<double, 3, 3, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
