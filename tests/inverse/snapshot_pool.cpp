#include "inverse/snapshot_pool.hpp"

#include <cstdint>
#include <cstring>
#include <set>
#include <stdexcept>

#include <catch2/catch.hpp>

using namespace jaxmpm;

TEST_CASE("a pool of snapshots hands out blocks of their own and uses those given back again") {
  SnapshotPool pool(make_state_memory(Backend::cpu));
  pool.prepare(1000, 3, 3);
  std::set<std::byte*> blocks;
  for (int k = 0; k < 3; ++k) {
    std::byte* block = pool.take();
    std::memset(block, k, 1000);
    CHECK(reinterpret_cast<std::uintptr_t>(block) % 64 == 0);
    blocks.insert(block);
  }
  CHECK(blocks.size() == 3);
  CHECK_THROWS_AS(pool.take(), std::logic_error);
  const std::size_t bytes = pool.bytes();
  for (std::byte* block : blocks) pool.give_back(block);
  pool.prepare(1000, 3, 3);
  for (int k = 0; k < 3; ++k) CHECK(blocks.count(pool.take()) == 1);
  CHECK(pool.bytes() == bytes);
  for (std::byte* block : blocks) pool.give_back(block);
  pool.prepare(1000, 2, 2);
  CHECK(pool.bytes() == 0);  // it had more than may be in use now
  pool.prepare(1000, 3, 2);
  blocks.clear();
  for (int k = 0; k < 3; ++k) blocks.insert(pool.take());
  CHECK(blocks.size() == 3);
  CHECK(pool.bytes() == bytes);
  for (std::byte* block : blocks) pool.give_back(block);
  pool.prepare(2000, 1, 1);
  CHECK(pool.bytes() == 0);
  pool.give_back(pool.take());
  CHECK(pool.bytes() >= 2000);
  pool.clear();
  CHECK(pool.bytes() == 0);
}
