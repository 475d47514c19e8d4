#include "inverse/snapshot_pool.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/round_up.hpp"

namespace jaxmpm {
namespace {

constexpr std::size_t chunk_bytes = std::size_t(32) << 20;

}  // namespace

void SnapshotPool::prepare(std::size_t bytes, std::size_t most, std::size_t expected) {
  bytes = whole_lines(bytes);
  if (bytes != block_bytes_ || touched_ > most) clear();
  block_bytes_ = bytes, most_ = most, expected_ = expected;
}

std::byte* SnapshotPool::take() {
  if (free_.empty()) add_chunk();
  std::byte* block = free_.back();
  free_.pop_back();
  touched_ = std::max(touched_, blocks_ - free_.size());  // those given back last are handed out first
  return block;
}

void SnapshotPool::add_chunk() {
  if (blocks_ >= most_) throw std::logic_error("more snapshots than planned");
  const std::size_t wanted = blocks_ < expected_ ? expected_ - blocks_ : 1;
  const std::size_t count = std::min(std::max<std::size_t>(chunk_bytes / block_bytes_, 1), wanted);
  chunks_.emplace_back(memory_->take(count * block_bytes_), Release{memory_.get()});
  for (std::size_t k = count; k-- > 0;) free_.push_back(chunks_.back().get() + k * block_bytes_);
  blocks_ += count;
}

}  // namespace jaxmpm
