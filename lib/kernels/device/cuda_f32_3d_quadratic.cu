#include "kernels/device/scheme_impl.hpp"

namespace jaxmpm {
template DeviceScheme<float, 3, Kokkos::Cuda> device_scheme<float, 3, 3, Kokkos::Cuda>(deck::Transfer, deck::GradientForm);
}
