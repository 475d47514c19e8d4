#include "inverse/snapshot_stack.hpp"

#include <algorithm>
#include <filesystem>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "../io/full_disk.hpp"
#include "../io/scratch.hpp"
#include "core/error.hpp"

using namespace jaxmpm;

namespace {

constexpr std::size_t bytes = 1000;

void push(SnapshotStack& stack, std::byte mark) { std::fill_n(stack.push(), bytes, mark); }

bool top_is(SnapshotStack& stack, std::byte mark) {
  const std::byte* top = stack.top();
  return std::all_of(top, top + bytes, [&](std::byte b) { return b == mark; });
}

}  // namespace

TEST_CASE("lean snapshots lie in memory of their own") {
  SnapshotStack stack(make_state_memory(Backend::cpu));
  constexpr std::size_t lean = 192;
  stack.prepare(bytes, {4, 0, 2, lean});
  push(stack, std::byte{1});
  for (const int mark : {2, 3}) std::fill_n(stack.push(true), lean, std::byte(mark));
  push(stack, std::byte{4});
  CHECK(top_is(stack, std::byte{4}));
  for (const int mark : {3, 2}) {
    stack.pop();
    CHECK(std::all_of(stack.top(), stack.top() + lean, [&](std::byte b) { return b == std::byte(mark); }));
  }
  stack.pop();
  CHECK(top_is(stack, std::byte{1}));
  const std::size_t taken = stack.memory_bytes();
  stack.prepare(bytes, {4, 0, 2, lean});
  for (const bool is_lean : {false, true, true, false}) stack.push(is_lean);
  CHECK(stack.memory_bytes() == taken);  // the same memory again
  stack.prepare(bytes, {2, 0});
  CHECK(stack.memory_bytes() < taken);  // what lean ones had is given back
}

TEST_CASE("a stack of snapshots gives back what was pushed, whichever of them are on disk") {
  std::mt19937 random(1);
  for (const std::size_t in_memory : {1, 2, 5})
    for (const std::size_t on_disk : {0, 1, 7}) {
      INFO(in_memory << " in memory, " << on_disk << " on disk");
      SnapshotStack stack(make_state_memory(Backend::cpu));
      stack.prepare(bytes, {in_memory, on_disk});
      std::vector<std::byte> marks;
      for (unsigned k = 0; k < 2000; ++k) {
        const bool up = marks.empty() || (marks.size() < in_memory + on_disk && random() % 2 == 0);
        if (up) marks.push_back(std::byte(k % 251)), push(stack, marks.back());
        else if (random() % 2 == 0) CHECK(top_is(stack, marks.back()));
        else marks.pop_back(), stack.pop();
        REQUIRE(stack.size() == marks.size());
      }
      CHECK(stack.memory_bytes() <= in_memory * 1024);
    }
}

TEST_CASE("what was fetched from the disk is not written again") {
  SnapshotStack stack(make_state_memory(Backend::cpu));
  stack.prepare(bytes, {2, 3});
  for (int k = 0; k < 5; ++k) push(stack, std::byte(k));
  CHECK(stack.file().written_bytes() == 3 * bytes);
  stack.pop(), stack.pop();
  CHECK(top_is(stack, std::byte(2)));
  CHECK(stack.file().read_bytes() == bytes);
  push(stack, std::byte(3)), push(stack, std::byte(4));  // 2 leaves memory, and is on the disk still
  CHECK(stack.file().written_bytes() == 3 * bytes);
  stack.pop(), stack.pop();
  CHECK(top_is(stack, std::byte(2)));
  stack.pop();
  push(stack, std::byte(9)), push(stack, std::byte(3)), push(stack, std::byte(4));  // another one in its place is not
  CHECK(stack.file().written_bytes() == 4 * bytes);
  stack.pop(), stack.pop();
  CHECK(top_is(stack, std::byte(9)));
}

TEST_CASE("what was fetched from the disk and changed is written again") {
  SnapshotStack stack(make_state_memory(Backend::cpu));
  stack.prepare(bytes, {1, 2});
  for (int k = 0; k < 3; ++k) push(stack, std::byte(k));
  stack.pop();
  std::fill_n(stack.change_top(), bytes, std::byte(9));
  push(stack, std::byte(2)), stack.pop();
  CHECK(top_is(stack, std::byte(9)));
  stack.pop();
  CHECK(top_is(stack, std::byte(0)));
}

TEST_CASE("the file of snapshots has no name") {
  const testing::Scratch scratch;
  SnapshotStack stack(make_state_memory(Backend::cpu), scratch / "");
  stack.prepare(bytes, {1, 2});
  for (int k = 0; k < 3; ++k) push(stack, std::byte(k));
  CHECK(stack.file().written_bytes() == 2 * bytes);
  CHECK(std::filesystem::is_empty(scratch / ""));
}

TEST_CASE("a disk without room for the snapshots is found out before the run") {
  const testing::Scratch scratch;
  const testing::FullDisk full(2500);
  SnapshotStack stack(make_state_memory(Backend::cpu), scratch / "");
  std::string said;
  try {
    stack.prepare(bytes, {1, 3});
  } catch (const IoError& error) {
    said = error.what();
  }
  for (const char* words : {"/inverse/disk", "too large"}) CHECK(said.find(words) != std::string::npos);
  CHECK_NOTHROW(stack.prepare(bytes, {1, 2}));
}
