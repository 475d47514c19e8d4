#pragma once
// Room for snapshots on a disk.
#include <cstddef>
#include <string>

namespace jaxmpm {

/// A file that has no name from the moment it is open, so that nothing is left of it however the program ends. It is opened when it is
/// first needed.
class SnapshotFile {
 public:
  /// Lies in `directory`, or in the system's temporary folder where there is no such directory.
  explicit SnapshotFile(std::string directory) : directory_(std::move(directory)) {}
  ~SnapshotFile();
  SnapshotFile(const SnapshotFile&) = delete;
  SnapshotFile& operator=(const SnapshotFile&) = delete;
  /// Places for `count` snapshots of `bytes`, reserved on the disk at once: a disk that is too full is found out before the run.
  /// Throws IoError.
  void prepare(std::size_t bytes, std::size_t count);
  /// Throw IoError.
  void write(std::size_t place, const std::byte* numbers);
  void read(std::size_t place, std::byte* numbers);
  /// Bytes written and read since prepare().
  std::size_t written_bytes() const { return written_; }
  std::size_t read_bytes() const { return read_; }

 private:
  void open();
  [[noreturn]] void fail(int reason) const;
  /// Moves a whole snapshot by pread or pwrite.
  template <class Bytes, class Move>
  void move(Move move_some, std::size_t place, Bytes* numbers);

  std::string directory_;
  int file_ = -1;
  std::size_t block_bytes_ = 0, reserved_ = 0, written_ = 0, read_ = 0;
};

}  // namespace jaxmpm
