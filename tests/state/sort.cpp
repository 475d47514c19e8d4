// Sorting: its order, and what it says of blocks and their neighbours.
#include "state/sort.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <random>
#include <tuple>

using namespace jaxmpm;

namespace {

constexpr int S = 3;
using Shape = BlockShape<2, S>;
const std::array<int, 3> cells{40, 24, 0};

/// Particles at places drawn over the domain, with ids in another order.
Particles<double, 2> cloud(std::size_t n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 1);
  Particles<double, 2> p;
  p.position.resize(2), p.velocity.resize(2);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t d = 0; d < 2; ++d) p.position[d].push_back(cells[d] * place(random)), p.velocity[d].push_back(p.position[d].back());
    p.mass.push_back(double(a)), p.compression.push_back(0), p.id.push_back(std::uint32_t((a * 7919) % n));
  }
  return p;
}

struct Sorted {
  Particles<double, 2> particles;
  Blocks<2> blocks;
  std::vector<std::int64_t> key;
  Index<2> extent = block_extent<2, S>(cells);
};

Sorted sorted(Particles<double, 2> particles, Index<2> period = {}) {
  Sorted s;
  SortScratch<double> scratch;
  s.particles = std::move(particles), s.blocks.period = period;
  sort_particles<S, double, 2>(s.particles, 0, s.extent, scratch, s.blocks.tiles, s.key);
  build_blocks<S, 2>(s.blocks, s.key, s.extent);
  return s;
}

/// Base node of a particle along an axis.
int base(const Particles<double, 2>& p, std::size_t a, std::size_t d) { return int(std::floor(p.position[d][a] - Bspline<S>::base_shift)); }

}  // namespace

TEST_CASE("particles are sorted by block, cell and id, whatever their order before, and keep their fields") {
  const Particles<double, 2> before = cloud(1000);
  const Sorted s = sorted(before);
  std::map<std::uint32_t, std::size_t> place;
  for (std::size_t a = 0; a < before.count(); ++a) place[before.id[a]] = a;
  REQUIRE(place.size() == 1000);
  std::size_t next = 0;
  for (const Tile& tile : s.blocks.tiles) {
    CHECK(tile.begin == next);
    std::tuple<int, std::uint32_t> last{-1, 0};
    for (std::size_t a = tile.begin; a < tile.end; ++a) {
      int cell = 0;
      for (std::size_t d = 0; d < 2; ++d) {
        const int in_block = base(s.particles, a, d) - Shape::first_node(s.blocks.index[tile.block][d]);
        CHECK((in_block >= 0 && in_block < Shape::B));
        cell = cell * Shape::B + in_block;
        const std::size_t from = place.at(s.particles.id[a]);
        CHECK(s.particles.position[d][a] == before.position[d][from]);
        CHECK(s.particles.velocity[d][a] == before.velocity[d][from]);
        CHECK(s.particles.mass[a] == before.mass[from]);
      }
      const std::tuple<int, std::uint32_t> own{cell, s.particles.id[a]};
      CHECK(last < own);
      last = own;
    }
    next = tile.end;
  }
  CHECK(next == 1000);
  const Sorted again = sorted(s.particles);  // the order is total: sorting what is sorted changes nothing
  CHECK(again.particles.id == s.particles.id);
}

TEST_CASE("a block exists where particles are and all around, and neighbours know each other") {
  Particles<double, 2> one = cloud(1);
  one.position[0][0] = 20.2, one.position[1][0] = 12.2;
  CHECK(sorted(one).blocks.count() == 9);
  const Sorted s = sorted(cloud(60));
  constexpr std::size_t around = Shape::neighbours;
  for (std::size_t b = 0; b < s.blocks.count(); ++b)
    for (std::size_t m = 0; m < around; ++m) {
      const int other = s.blocks.neighbour[b * around + m];
      if (m == around / 2) CHECK(other == int(b));
      if (other == Blocks<2>::none) continue;
      CHECK(s.blocks.neighbour[std::size_t(other) * around + (around - 1 - m)] == int(b));
      for (std::size_t d = 0; d < 2; ++d)
        CHECK(s.blocks.index[std::size_t(other)][d] - s.blocks.index[b][d] == int(d == 0 ? m / 3 : m % 3) - 1);
    }
  for (const Tile& tile : s.blocks.tiles)
    for (std::size_t m = 0; m < around; ++m) CHECK(s.blocks.neighbour[tile.block * around + m] != Blocks<2>::none);
}

TEST_CASE("each block is told of every tile that reaches it, in a fixed order") {
  const Sorted s = sorted(cloud(200));
  std::size_t told = 0;
  for (std::size_t b = 0; b < s.blocks.count(); ++b)
    for (std::uint32_t k = s.blocks.first_contribution[b]; k < s.blocks.first_contribution[b + 1]; ++k, ++told) {
      const Contribution& from = s.blocks.contributions[k];
      CHECK(s.blocks.neighbour[b * Shape::neighbours + from.neighbour] == int(s.blocks.tiles[from.tile].block));
      if (k > s.blocks.first_contribution[b]) CHECK(s.blocks.contributions[k - 1].neighbour <= from.neighbour);
    }
  CHECK(told == s.blocks.tiles.size() * Shape::neighbours);  // all neighbours of a block with particles exist
}

TEST_CASE("across periodic faces the last block is the first one's neighbour") {
  Particles<double, 2> edge = cloud(1);
  edge.position[0][0] = 0.7, edge.position[1][0] = 12.2;  // base node 0: in the first block
  const int blocks_along = cells[0] / Shape::B;
  const Sorted s = sorted(edge, {blocks_along, 0});
  CHECK(s.blocks.count() == 9);
  const std::size_t home = s.blocks.tiles[0].block;
  const int before = s.blocks.neighbour[home * Shape::neighbours + 1];  // (−1, 0)
  REQUIRE(before != Blocks<2>::none);
  CHECK(s.blocks.index[home][0] == Shape::margin);
  CHECK(s.blocks.index[std::size_t(before)][0] == Shape::margin + blocks_along - 1);
}
