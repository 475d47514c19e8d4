#pragma once
// The numbers of the states that a reverse run keeps, on two levels: the newest, which are needed first, in memory, older ones on a disk.
#include "inverse/snapshot_file.hpp"
#include "inverse/snapshot_pool.hpp"

namespace jaxmpm {

/// How many snapshots of a run there is room for, and where. Where all are in memory, some may be lean: of fewer bytes.
struct SnapshotRoom {
  std::size_t in_memory = 1, on_disk = 0;  // in_memory ≥ 1
  std::size_t lean = 0, lean_bytes = 0;    // how many are, about
};

/// When memory is full, a new snapshot sends the oldest one in memory to the disk; one that comes to be the newest is fetched back. What
/// has been fetched stays valid on the disk, so that no snapshot is written twice. Serves gradient after gradient with the same memory and
/// file.
class SnapshotStack {
 public:
  /// `memory`: of the steppers whose states it keeps; `directory`: of the file (SnapshotFile).
  explicit SnapshotStack(std::shared_ptr<StateMemory> memory, std::string directory = {})
      : pool_(memory), lean_pool_(std::move(memory)), file_(std::move(directory)) {}
  /// Empties the stack. Snapshots are of `bytes` from now on, or lean. Throws IoError where the disk has no room for its part.
  void prepare(std::size_t bytes, const SnapshotRoom& room);
  std::size_t size() const { return blocks_.size(); }
  /// A new snapshot's memory. Throws IoError.
  std::byte* push(bool lean = false);
  /// The newest snapshot. Throws IoError.
  const std::byte* top();
  /// The same, to be changed.
  std::byte* change_top();
  void pop();
  /// Whether the one below the newest is on the disk alone, so that pop() and top() will overwrite what the newest lies in.
  bool fetches_next() const { return size() > 1 && first_in_memory_ >= size() - 1; }
  /// Bytes of memory taken from the system.
  std::size_t memory_bytes() const { return pool_.bytes() + lean_pool_.bytes(); }
  const StateMemory& memory() const { return pool_.memory(); }
  const SnapshotFile& file() const { return file_; }

 private:
  void spill();

  SnapshotPool pool_, lean_pool_;
  SnapshotFile file_;
  bool some_lean_ = false;
  std::size_t in_memory_ = 0;
  std::vector<std::byte> passing_;   // a snapshot on its way to or from the disk
  std::vector<std::byte*> blocks_;   // oldest first
  std::vector<bool> lean_;           // [block]
  std::size_t first_in_memory_ = 0;  // blocks_ before it are on the disk alone
  std::size_t in_file_ = 0;          // the file holds the first so many, each at its number
};

}  // namespace jaxmpm
