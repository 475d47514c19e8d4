#include "inverse/snapshot_file.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/error.hpp"

namespace jaxmpm {

SnapshotFile::~SnapshotFile() {
  if (file_ >= 0) close(file_);
}

void SnapshotFile::prepare(std::size_t bytes, std::size_t count) {
  block_bytes_ = bytes, written_ = read_ = 0;
  const std::size_t needed = bytes * count;
  if (needed <= reserved_) return;
  open();
  int failed = 0;
  do failed = posix_fallocate(file_, 0, static_cast<off_t>(needed));
  while (failed == EINTR);
  if (failed != 0) fail(failed);
  reserved_ = needed;
}

void SnapshotFile::write(std::size_t place, const std::byte* numbers) {
  move(pwrite, place, numbers);
  written_ += block_bytes_;
}

void SnapshotFile::read(std::size_t place, std::byte* numbers) {
  move(pread, place, numbers);
  read_ += block_bytes_;
}

void SnapshotFile::open() {
  namespace fs = std::filesystem;
  if (file_ >= 0) return;
  std::error_code failed;
  if (!fs::is_directory(directory_, failed)) directory_ = fs::temp_directory_path(failed).string();
  std::string path = directory_ + "/snapshots-XXXXXX";
  file_ = mkostemp(path.data(), O_CLOEXEC);
  if (file_ < 0 || unlink(path.c_str()) != 0) fail(errno);
}

void SnapshotFile::fail(int reason) const {
  throw IoError(
      fmt::format("cannot keep snapshots of the gradient in '{}': {}. Make room there, give a smaller /inverse/disk, or choose another "
                  "directory (-o, or /output/directory); nothing is left of the snapshots, and what an inversion has found so far is kept: "
                  "it goes on with --resume auto.",
                  directory_, std::strerror(reason)));
}

template <class Bytes, class Move>
void SnapshotFile::move(Move move_some, std::size_t place, Bytes* numbers) {
  for (std::size_t done = 0; done < block_bytes_;) {
    const ssize_t n = move_some(file_, numbers + done, block_bytes_ - done, static_cast<off_t>(place * block_bytes_ + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(n < 0 ? errno : EIO);
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace jaxmpm
