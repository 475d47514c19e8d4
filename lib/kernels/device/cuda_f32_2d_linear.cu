#include "kernels/device/scheme_impl.hpp"

namespace jaxmpm {
template DeviceScheme<float, 2, Kokkos::Cuda> device_scheme<float, 2, 2, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
