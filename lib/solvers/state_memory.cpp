#include <cstring>
#include <new>

#include "core/provenance.hpp"
#include "solvers/reversible.hpp"
#if defined(KOKKOS_ENABLE_CUDA)
#include "solvers/cuda_solver.hpp"
#endif

namespace jaxmpm {
namespace {

constexpr std::align_val_t cache_line{64};

class HostMemory final : public StateMemory {
 public:
  Backend backend() const override { return Backend::cpu; }
  std::byte* take(std::size_t bytes) override { return static_cast<std::byte*>(::operator new(bytes, cache_line)); }
  void give_back(std::byte* block) noexcept override { ::operator delete(block, cache_line); }
  void copy_out(std::byte* host, const std::byte* block, std::size_t bytes) const override { std::memcpy(host, block, bytes); }
  void copy_in(std::byte* block, const std::byte* host, std::size_t bytes) const override { std::memcpy(block, host, bytes); }
  std::size_t used() const override { return resident_bytes(); }
  std::size_t most_used() const override { return peak_memory_bytes(); }
};

}  // namespace

#if defined(KOKKOS_ENABLE_CUDA)
std::shared_ptr<StateMemory> make_state_memory(Backend backend) {
  return backend == Backend::cuda ? make_cuda_state_memory() : std::make_shared<HostMemory>();
}
#else
std::shared_ptr<StateMemory> make_state_memory(Backend) { return std::make_shared<HostMemory>(); }
#endif

}  // namespace jaxmpm
