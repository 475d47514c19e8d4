#pragma once
// Files that appear whole or not at all: written beside their place under a temporary name, brought to disk, then renamed.
#include <string>

#include "core/error.hpp"

namespace jaxmpm {

/// A file in the making. Write to temporary(), then commit(); a file that is not committed disappears.
class PendingFile {
 public:
  explicit PendingFile(std::string path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  const std::string& temporary() const { return temporary_; }
  /// Throws IoError with path and reason.
  void commit();

 private:
  std::string path_, temporary_;
  bool committed_ = false;
};

/// Writes a whole file. Throws IoError with path and reason (disk full, not permitted, …).
void write_file(const std::string& path, const std::string& bytes);
/// Throws IoError with path and reason.
std::string read_file(const std::string& path);
/// Makes a directory and those above it, and makes sure that files can be written there. Throws IoError.
void make_directory(const std::string& path);
/// Renames within a directory. Throws IoError.
void rename_file(const std::string& from, const std::string& to);
/// Removes a file, and one in the making beside it, if they are there. Throws IoError.
void remove_file(const std::string& path);
/// What every message about a file that cannot be written ends with.
IoError cannot_write(const std::string& path, const std::string& reason);

}  // namespace jaxmpm
