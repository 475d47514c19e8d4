#pragma once
// Memory for the states that a reverse run keeps. Fresh memory may cost as much as the steps themselves (each page is cleared when it is
// first touched), so what was given back is used again, by the next gradient as well.
#include <cstddef>
#include <memory>
#include <vector>

#include "solvers/reversible.hpp"

namespace jaxmpm {

class SnapshotPool {
 public:
  explicit SnapshotPool(std::shared_ptr<StateMemory> memory) : memory_(std::move(memory)) {}
  /// Blocks of `bytes` from now on, at most `most` of them at once; memory is taken in large pieces for `expected` of them, and for one after
  /// the other beyond. None may be in use. Keeps the memory of before when the size is the same and it is not more than `most`.
  void prepare(std::size_t bytes, std::size_t most, std::size_t expected);
  std::byte* take();
  /// What the block holds stays until it is taken again.
  void give_back(std::byte* block) { free_.push_back(block); }
  /// Gives all memory back to the system.
  void clear() { chunks_.clear(), free_.clear(), blocks_ = touched_ = 0; }
  /// Bytes in use, or used before and kept. What has been taken from the system but not touched yet is no one's.
  std::size_t bytes() const { return touched_ * block_bytes_; }
  const StateMemory& memory() const { return *memory_; }

 private:
  struct Release {
    StateMemory* memory;
    void operator()(std::byte* chunk) const { memory->give_back(chunk); }
  };
  void add_chunk();

  std::shared_ptr<StateMemory> memory_;
  std::size_t block_bytes_ = 0, most_ = 0, expected_ = 0, blocks_ = 0, touched_ = 0;
  std::vector<std::unique_ptr<std::byte, Release>> chunks_;
  std::vector<std::byte*> free_;
};

}  // namespace jaxmpm
