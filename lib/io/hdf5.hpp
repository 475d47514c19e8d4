#pragma once
// The little of HDF5 that results need, with errors as IoError: path, what failed and the reason the system gave.
#include <hdf5.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/files.hpp"

namespace jaxmpm::hdf5 {

/// An HDF5 identifier that is closed with its owner.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }
  herr_t reset();
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

struct Attribute {
  std::string name, text;
};

/// How a dataset is stored: checked ones carry checksums, so that damage is noticed when they are read.
enum class Storage { plain, checked };

/// A file being written; appears under its name with finish(), or not at all.
class Writer {
 public:
  explicit Writer(const std::string& path);
  ~Writer();
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void attribute(const std::string& object, const std::string& name, const std::vector<std::string>& values);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::uint64_t value);
  /// Makes a group and those above it.
  void group(const std::string& name);
  /// `type` is "f4", "f8", "u1", "u4", "i8" or "u8". Groups on the way are made.
  void dataset(const std::string& name, const std::string& type, const std::vector<std::size_t>& shape, const void* data,
               Storage storage = Storage::plain);
  void dataset(const std::string& name, const std::vector<std::size_t>& shape, const std::vector<double>& values,
               Storage storage = Storage::plain);
  /// Text as a checked dataset of bytes; an attribute's text has no checksum.
  void text(const std::string& name, const std::string& value);
  /// A link to an object of another file; `file` is relative to this one's directory.
  void external_link(const std::string& name, const std::string& file, const std::string& object);
  void finish();

 private:
  Handle make_attribute(const std::string& object, const std::string& name, hid_t type, hid_t space);
  hid_t checked(hid_t result, const std::string& what) const;  ///< throws when an HDF5 call has failed

  std::string path_;
  PendingFile pending_;
  Handle file_;
};

/// A file being read. Every call throws IoError when the file is damaged or the object is missing.
class Reader {
 public:
  explicit Reader(const std::string& path);
  const std::string& path() const { return path_; }
  bool has(const std::string& object) const;
  std::vector<std::string> names(const std::string& group) const;  ///< in the order of names
  std::string text_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  std::uint64_t count_attribute(const std::string& object, const std::string& name) const;
  std::vector<std::size_t> shape(const std::string& dataset) const;
  std::string type(const std::string& dataset) const;
  /// Converts to the type asked for.
  std::vector<double> numbers(const std::string& dataset) const;
  std::vector<std::uint64_t> counts(const std::string& dataset) const;
  std::vector<unsigned char> bytes(const std::string& dataset) const;  ///< as stored
  std::string text(const std::string& dataset) const;

 private:
  Handle open(const std::string& dataset) const;
  void read(const std::string& dataset, hid_t type, void* into) const;
  hid_t checked(hid_t result, const std::string& what) const;

  std::string path_;
  Handle file_;
};

/// Bytes of one value of a type name.
std::size_t type_size(const std::string& type);

}  // namespace jaxmpm::hdf5
