#include <sys/mman.h>

#include <cstring>
#include <map>
#include <new>

#include "core/provenance.hpp"
#include "solvers/reversible.hpp"
#if defined(KOKKOS_ENABLE_CUDA)
#include "solvers/cuda_solver.hpp"
#endif

namespace jaxmpm {
namespace {

/// Blocks come from the system and go back to it at once: what is freed in the heap may stay in use, and count in a budget.
class HostMemory final : public StateMemory {
 public:
  Backend backend() const override { return Backend::cpu; }
  ~HostMemory() override {
    while (!size_.empty()) give_back(size_.begin()->first);
  }
  std::byte* take(std::size_t bytes) override {
    void* block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) throw std::bad_alloc();
    size_[static_cast<std::byte*>(block)] = bytes;
    return static_cast<std::byte*>(block);
  }
  void give_back(std::byte* block) noexcept override {
    const auto at = size_.find(block);
    munmap(block, at->second);
    size_.erase(at);
  }
  void copy_out(std::byte* host, const std::byte* block, std::size_t bytes) const override { std::memcpy(host, block, bytes); }
  void copy_in(std::byte* block, const std::byte* host, std::size_t bytes) const override { std::memcpy(block, host, bytes); }
  std::size_t used() const override { return resident_bytes(); }
  std::size_t most_used() const override { return peak_memory_bytes(); }

 private:
  std::map<std::byte*, std::size_t> size_;
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
