#pragma once
// The numbers of the states that a reverse run keeps, on two levels: the newest, which are needed first, in memory, older ones on a disk.
#include "inverse/snapshot_file.hpp"
#include "inverse/snapshot_pool.hpp"

namespace jaxmpm {

/// When memory is full, a new snapshot sends the oldest one in memory to the disk; one that comes to be the newest is fetched back. What
/// has been fetched stays valid on the disk, so that no snapshot is written twice. Serves gradient after gradient with the same memory and
/// file.
class SnapshotStack {
 public:
  /// `memory`: of the steppers whose states it keeps; `directory`: of the file (SnapshotFile).
  explicit SnapshotStack(std::shared_ptr<StateMemory> memory, std::string directory = {})
      : pool_(std::move(memory)), file_(std::move(directory)) {}
  /// Empties the stack. Snapshots are of `bytes` from now on, at most `in_memory` ≥ 1 of them in memory and `on_disk` others.
  /// Throws IoError where the disk has no room for these.
  void prepare(std::size_t bytes, std::size_t in_memory, std::size_t on_disk);
  std::size_t size() const { return blocks_.size(); }
  /// A new snapshot's memory. Throws IoError.
  std::byte* push();
  /// The newest snapshot. Throws IoError.
  const std::byte* top();
  /// The same, to be changed.
  std::byte* change_top();
  void pop();
  /// Bytes of memory taken from the system.
  std::size_t memory_bytes() const { return pool_.bytes(); }
  const StateMemory& memory() const { return pool_.memory(); }
  const SnapshotFile& file() const { return file_; }

 private:
  void spill();

  SnapshotPool pool_;
  SnapshotFile file_;
  std::size_t in_memory_ = 0;
  std::vector<std::byte> passing_;   // a snapshot on its way to or from the disk
  std::vector<std::byte*> blocks_;   // oldest first
  std::size_t first_in_memory_ = 0;  // blocks_ before it are on the disk alone
  std::size_t in_file_ = 0;          // the file holds the first so many, each at its number
};

}  // namespace jaxmpm
