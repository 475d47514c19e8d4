// Sums of nodes without those that nothing reaches, and back.
#include "solvers/packed_sums.hpp"

#include <catch2/catch.hpp>
#include <random>

using namespace jaxmpm;

namespace {

template <class T>
void check(int planes) {
  CAPTURE(sizeof(T), planes);
  constexpr std::size_t blocks = 9, cells = PackedSums<T>::cells;
  const std::size_t size = std::size_t(planes) * cells * 4;
  std::vector<T> sums(blocks * size);
  std::mt19937_64 random(5);
  for (std::size_t b = 0; b < blocks; ++b)  // from an empty block to a full one
    for (std::size_t node = 0; node < cells; ++node)
      if (random() % (blocks - 1) < b)
        sums[b * size + (random() % std::size_t(planes) * cells + node) * 4 + random() % 4] = T(1 + random() % 7);
  PackedSums<T> packed(planes);
  const auto of = [&](std::size_t b) { return sums.data() + b * size; };
  std::vector<std::byte> memory(packed.most_bytes(blocks) + 64, std::byte(0xFF));
  packed.begin(blocks);
  for (std::size_t b = 0; b < blocks; ++b) packed.look_at(b, of(b));
  packed.pack(of, memory.data());
  for (std::size_t i = packed.most_bytes(blocks); i < memory.size(); ++i) REQUIRE(memory[i] == std::byte(0xFF));

  PackedSums<T> other(planes);
  other.open(blocks, memory.data());
  for (std::size_t b = blocks; b-- > 0;) {
    std::vector<T> found(size, T(-1));
    other.unpack(b, found.data());
    REQUIRE(std::equal(found.begin(), found.end(), of(b)));
  }
}

}  // namespace

TEST_CASE("packed sums of nodes are the same when they are unpacked") {
  for (const int planes : {1, 2}) check<double>(planes), check<float>(planes);
}
