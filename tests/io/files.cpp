// Files appear whole or not at all; errors give path and reason.
#include "io/files.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "full_disk.hpp"
#include "io/hdf5.hpp"
#include "scratch.hpp"

using namespace jaxmpm;
namespace fs = std::filesystem;

namespace {

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("write_file replaces a file whole") {
  const testing::Scratch scratch;
  const std::string path = scratch / "a.txt";
  write_file(path, "one");
  write_file(path, "two");
  CHECK(read_file(path) == "two");
  CHECK_FALSE(fs::exists(path + ".tmp"));
}

TEST_CASE("a full disk leaves the old file and nothing half-written") {
  const testing::Scratch scratch;
  const std::string path = scratch / "a.txt";
  write_file(path, "old");
  const testing::FullDisk full(1000);
  const std::string message = message_of([&] { write_file(path, std::string(100000, 'x')); });
  CHECK(message.find(path) != std::string::npos);
  CHECK(message.find("File too large") != std::string::npos);
  CHECK(read_file(path) == "old");
  CHECK_FALSE(fs::exists(path + ".tmp"));
}

TEST_CASE("HDF5 on a full disk gives the system's reason and leaves nothing behind") {
  const testing::Scratch scratch;
  const std::string path = scratch / "a.h5";
  const testing::FullDisk full(20000);
  const std::string message = message_of([&] {
    hdf5::Writer file(path);
    file.dataset("/x", {100000}, std::vector<double>(100000, 1.0));
    file.finish();
  });
  CHECK(message.find(path) != std::string::npos);
  CHECK(message.find("File too large") != std::string::npos);
  CHECK_FALSE(fs::exists(path));
  CHECK_FALSE(fs::exists(path + ".tmp"));
}

TEST_CASE("a directory that cannot be made says why") {
  const testing::Scratch scratch;
  write_file(scratch / "file", "");
  CHECK(message_of([&] { make_directory(scratch / "file/below"); }).find("Not a directory") != std::string::npos);
  CHECK(message_of([&] { make_directory("/proc/nowhere"); }).find("/proc/nowhere") != std::string::npos);
}

TEST_CASE("HDF5 gives back what was written") {
  const testing::Scratch scratch;
  const std::string path = scratch / "a.h5";
  {
    hdf5::Writer file(path);
    file.attribute("/", "text", std::string("π, and a long deck"));
    file.attribute("/", "count", std::uint64_t(7));
    file.dataset("/group/numbers", {2, 3}, {1, 2, 3, 4, 5, 6}, hdf5::Storage::checked);
    file.dataset("/group/none", {0, 3}, {}, hdf5::Storage::checked);
    file.attribute("/group/numbers", "components", std::vector<std::string>{"a", "b", "c"});
    CHECK_FALSE(fs::exists(path));
    file.finish();
  }
  const hdf5::Reader file(path);
  CHECK(file.text_attribute("/", "text") == "π, and a long deck");
  CHECK(file.count_attribute("/", "count") == 7);
  CHECK(file.shape("/group/numbers") == std::vector<std::size_t>{2, 3});
  CHECK(file.type("/group/numbers") == "f8");
  CHECK(file.numbers("/group/numbers") == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(file.numbers("/group/none").empty());
  CHECK(file.names("/group") == std::vector<std::string>{"none", "numbers"});
  CHECK_THROWS_AS(file.numbers("/group/other"), IoError);
  CHECK_THROWS_AS(hdf5::Reader(scratch / "missing.h5"), IoError);
}
