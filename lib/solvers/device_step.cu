// The stepper on the GPU.
#include "solvers/cuda_solver.hpp"
#include "solvers/device_step_impl.hpp"

namespace jaxmpm {
namespace {

template <class T, int Dim>
std::unique_ptr<Solver> make(const Model& model) {
  using Stepper = DeviceStep<T, Dim, Kokkos::Cuda>;
  const deck::Method& method = model.method;
  return with_spline(method.basis, [&](auto nodes) -> std::unique_ptr<Solver> {
    return std::make_unique<Stepper>(model, device_scheme<T, Dim, nodes, Kokkos::Cuda>(method.transfer, method.gradient));
  });
}

}  // namespace

std::unique_ptr<Solver> make_cuda_solver(const Model& model) {
  if (model.method.precision == deck::Precision::f32) return model.dim == 2 ? make<float, 2>(model) : make<float, 3>(model);
  return model.dim == 2 ? make<double, 2>(model) : make<double, 3>(model);
}

}  // namespace jaxmpm
