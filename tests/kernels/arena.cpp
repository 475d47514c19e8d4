// The copy of the grid to a tile's arena.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "kernels/grid.hpp"

using namespace jaxmpm;

TEST_CASE("a loaded arena holds no garbage, not even behind its last node") {
  using Sch = Scheme<double, 2, 3, deck::Transfer::flip, false>;
  Blocks<2> blocks;
  blocks.index.assign(9, {0, 0});
  blocks.neighbour = {0, 1, 2, 3, 4, 5, 6, 7, 8};  // of block 0, all that is asked for
  const std::vector<double> grid(9 * Sch::own_size, 1.5);
  std::vector<double> arena(Sch::arena_size, std::numeric_limits<double>::quiet_NaN());
  load_arena<Sch>(blocks, 0, grid.data(), arena.data());
  for (int plane = 0; plane < Sch::planes; ++plane)
    for (int i = 0; i < Sch::arena_plane; ++i)
      REQUIRE(arena[std::size_t(plane * Sch::arena_plane + i)] == (i < 4 * Sch::Shape::arena_nodes ? 1.5 : 0.0));
}
