#include "inverse/snapshot_stack.hpp"

#include <algorithm>

namespace jaxmpm {

void SnapshotStack::prepare(std::size_t bytes, const SnapshotRoom& room) {
  while (!blocks_.empty()) pop();
  const bool some_lean = room.lean > 0;
  if (some_lean != some_lean_) pool_.clear();  // it will need another number of blocks
  some_lean_ = some_lean;
  pool_.prepare(bytes, room.in_memory, room.in_memory - room.lean);
  lean_pool_.prepare(some_lean ? room.lean_bytes : 0, room.in_memory, room.lean);
  file_.prepare(bytes, room.on_disk);
  passing_.resize(room.on_disk > 0 ? bytes : 0);
  in_memory_ = room.in_memory;
}

std::byte* SnapshotStack::push(bool lean) {
  if (size() - first_in_memory_ == in_memory_) spill();
  blocks_.push_back((lean ? lean_pool_ : pool_).take());
  lean_.push_back(lean);
  return blocks_.back();
}

void SnapshotStack::spill() {
  const std::size_t oldest = first_in_memory_;
  if (oldest == in_file_) {
    memory().copy_out(passing_.data(), blocks_[oldest], passing_.size());
    file_.write(oldest, passing_.data());
    ++in_file_;
  }
  pool_.give_back(blocks_[oldest]);
  ++first_in_memory_;
}

const std::byte* SnapshotStack::top() {
  if (first_in_memory_ == size()) {  // the newest is on the disk, so memory is empty
    blocks_.back() = pool_.take();
    --first_in_memory_;
    file_.read(first_in_memory_, passing_.data());
    memory().copy_in(blocks_.back(), passing_.data(), passing_.size());
  }
  return blocks_.back();
}

std::byte* SnapshotStack::change_top() {
  top();
  in_file_ = std::min(in_file_, size() - 1);  // what the file has of it is out of date
  return blocks_.back();
}

void SnapshotStack::pop() {
  if (first_in_memory_ < size()) (lean_.back() ? lean_pool_ : pool_).give_back(blocks_.back());
  blocks_.pop_back(), lean_.pop_back();
  first_in_memory_ = std::min(first_in_memory_, size()), in_file_ = std::min(in_file_, size());
}

}  // namespace jaxmpm
