#include "io/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace jaxmpm {
namespace {

namespace fs = std::filesystem;

void bring_to_disk(const std::string& path, int flags) {
  const int file = open(path.c_str(), flags);
  if (file < 0) throw cannot_write(path, std::strerror(errno));
  const int failed = fsync(file);
  const int reason = errno;
  close(file);
  if (failed && reason != EINVAL) throw cannot_write(path, std::strerror(reason));  // EINVAL: a file system that has no fsync
}

void write_all(int file, const std::string& path, const std::string& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t n = write(file, bytes.data() + written, bytes.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      close(file);
      throw cannot_write(path, std::strerror(reason));
    }
    written += static_cast<std::size_t>(n);
  }
  if (close(file) != 0) throw cannot_write(path, std::strerror(errno));
}

}  // namespace

IoError cannot_write(const std::string& path, const std::string& reason) {
  return IoError(
      "cannot write '" + path + "': " + reason +
      ". Make room there or permit writing, or choose another directory with -o; nothing half-written was left under that name.");
}

PendingFile::PendingFile(std::string path) : path_(std::move(path)), temporary_(path_ + ".tmp") {}

PendingFile::~PendingFile() {
  if (!committed_) unlink(temporary_.c_str());
}

void PendingFile::commit() {
  bring_to_disk(temporary_, O_RDONLY);
  rename_file(temporary_, path_);
  committed_ = true;
  const std::string parent = fs::path(path_).parent_path().string();
  bring_to_disk(parent.empty() ? "." : parent, O_RDONLY | O_DIRECTORY);
}

void write_file(const std::string& path, const std::string& bytes) {
  PendingFile pending(path);
  const int file = open(pending.temporary().c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0) throw cannot_write(path, std::strerror(errno));
  write_all(file, path, bytes);
  pending.commit();
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw IoError("cannot read '" + path + "': " + std::strerror(errno) + ".");
  return text.str();
}

void make_directory(const std::string& path) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) throw cannot_write(path, failed.message());
  if (!fs::is_directory(path)) throw cannot_write(path, "it is no directory");
  write_file((fs::path(path) / ".writable").string(), "jaxmpm\n");  // as root, permissions alone do not tell
  fs::remove(fs::path(path) / ".writable", failed);
}

void remove_file(const std::string& path) {
  for (const std::string& file : {path, path + ".tmp"}) {
    std::error_code failed;
    fs::remove(file, failed);
    if (failed) throw IoError("cannot remove '" + file + "': " + failed.message() + ".");
  }
}

void rename_file(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) throw cannot_write(to, std::strerror(errno));
}

}  // namespace jaxmpm
