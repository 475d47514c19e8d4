// The stepper with its adjoint on the GPU.
#include "solvers/cuda_solver.hpp"
#include "solvers/device_reversible_step_impl.hpp"

namespace jaxmpm {
namespace {

template <class T, int Dim>
std::unique_ptr<ReversibleSolver> make(const Model& model) {
  const deck::Method& method = model.method;
  return with_spline(method.basis, [&](auto nodes) -> std::unique_ptr<ReversibleSolver> {
    return std::make_unique<DeviceReversibleStep<T, Dim, Kokkos::Cuda>>(
        model, device_scheme<T, Dim, nodes, Kokkos::Cuda>(method.transfer, method.gradient),
        device_adjoint<T, Dim, nodes, Kokkos::Cuda>(method.transfer, method.gradient));
  });
}

/// All of the card's memory counts as used that is not free.
class CudaMemory final : public StateMemory {
  using Memory = Kokkos::CudaSpace;
  template <class V>
  using Bytes = Kokkos::View<V*, Memory, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
  template <class V>
  using HostBytes = Kokkos::View<V*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
  mutable std::size_t most_ = 0;

 public:
  Backend backend() const override { return Backend::cuda; }
  std::byte* take(std::size_t bytes) override {
    auto* block = static_cast<std::byte*>(Kokkos::kokkos_malloc<Memory>("jaxmpm::states", bytes));
    used();
    return block;
  }
  void give_back(std::byte* block) noexcept override { Kokkos::kokkos_free<Memory>(block); }
  void copy_out(std::byte* host, const std::byte* block, std::size_t bytes) const override {
    Kokkos::deep_copy(HostBytes<unsigned char>(reinterpret_cast<unsigned char*>(host), bytes),
                      Bytes<const unsigned char>(reinterpret_cast<const unsigned char*>(block), bytes));
  }
  void copy_in(std::byte* block, const std::byte* host, std::size_t bytes) const override {
    Kokkos::deep_copy(Bytes<unsigned char>(reinterpret_cast<unsigned char*>(block), bytes),
                      HostBytes<const unsigned char>(reinterpret_cast<const unsigned char*>(host), bytes));
  }
  std::size_t used() const override {
    std::size_t free = 0, all = 0;
    if (cudaMemGetInfo(&free, &all) != cudaSuccess) return most_;
    most_ = std::max(most_, all - free);
    return all - free;
  }
  std::size_t most_used() const override { return used(), most_; }
};

}  // namespace

std::unique_ptr<ReversibleSolver> make_cuda_reversible_solver(const Model& model) {
  if (model.method.precision == deck::Precision::f32) return model.dim == 2 ? make<float, 2>(model) : make<float, 3>(model);
  return model.dim == 2 ? make<double, 2>(model) : make<double, 3>(model);
}

std::shared_ptr<StateMemory> make_cuda_state_memory() { return std::make_shared<CudaMemory>(); }

}  // namespace jaxmpm
