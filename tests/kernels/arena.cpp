// The nodes around a tile, copied from the grid.
#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "kernels/stencil.hpp"

using namespace jaxmpm;

namespace {

/// A value that tells its block, plane, node and place in the quad.
template <class Sch>
double value(int block, int plane, int node, int c) {
  return 1 + c + 4 * (node + Sch::Shape::cells * (plane + Sch::planes * block));
}

/// Block 0 as if in the middle of blocks 0 … neighbours − 1.
template <class Sch>
struct Surroundings {
  static constexpr int neighbours = Sch::Shape::neighbours;
  Blocks<Sch::Dim> blocks;
  std::vector<double> grid;
  Surroundings() {
    blocks.index.assign(neighbours, {});
    for (int m = 0; m < neighbours; ++m) blocks.neighbour.push_back(m);
    for (int block = 0; block < neighbours; ++block)
      for (int plane = 0; plane < Sch::planes; ++plane)
        for (int node = 0; node < Sch::Shape::cells; ++node)
          for (int c = 0; c < 4; ++c) grid.push_back(value<Sch>(block, plane, node, c));
  }
  /// Of node (i, j[, k]) of the arena.
  double expected(const std::array<int, 3>& at, int plane, int c) const {
    constexpr int B = Sch::Shape::B;
    int block = 0, node = 0;
    for (int d = 0; d < Sch::Dim; ++d) {
      const int own = at[std::size_t(d)] - 1;  // node 0 of the arena is one below the block
      const int step = own < 0 ? 0 : (own < B ? 1 : 2);
      block = 3 * block + step, node = B * node + own - (step - 1) * B;
    }
    return value<Sch>(block, plane, node, c);
  }
};

template <class Sch, class F>
void for_each_arena_node(F f) {
  constexpr int A = Sch::Shape::A;
  for (int i = 0; i < A; ++i)
    for (int j = 0; j < A; ++j)
      for (int k = 0; k < (Sch::Dim == 3 ? A : 1); ++k) f(std::array<int, 3>{i, j, k}, Sch::Shape::arena_node(i, j, k));
}

}  // namespace

TEST_CASE("the nodes around a tile are those of the blocks around it, and no garbage lies behind the last: 2D") {
  using Sch = Scheme<double, 2, 3, deck::Transfer::flip, false, true>;
  const Surroundings<Sch> around;
  const auto nodes = std::make_unique<Nodes<Sch, true>>(around.blocks, 0, around.grid.data());
  for_each_arena_node<Sch>([&](const std::array<int, 3>& at, int node) {
    for (int plane = 0; plane < Sch::planes; ++plane)
      for (int c = 0; c < 2; ++c) REQUIRE(nodes->pair[plane][2 * node + c] == around.expected(at, plane, 1 + c));
    REQUIRE(nodes->mass[node] == around.expected(at, 0, 0));
    REQUIRE(nodes->theta[node] == around.expected(at, 0, 3));
  });
  for (int node = Sch::Shape::arena_nodes; node < nodes->count; ++node) {
    for (const auto& plane : nodes->pair) REQUIRE((plane[2 * node] == 0 && plane[2 * node + 1] == 0));
    REQUIRE((nodes->mass[node] == 0 && nodes->theta[node] == 0));
  }
}

TEST_CASE("the nodes around a tile are those of the blocks around it, and no garbage lies behind the last: 3D") {
  using Sch = Scheme<double, 3, 3, deck::Transfer::flip, false>;
  const Surroundings<Sch> around;
  const auto nodes = std::make_unique<Nodes<Sch, false>>(around.blocks, 0, around.grid.data());
  for (int plane = 0; plane < Sch::planes; ++plane) {
    const double* values = nodes->value + plane * Sch::arena_plane;
    for_each_arena_node<Sch>([&](const std::array<int, 3>& at, int node) {
      for (int c = 0; c < 4; ++c) REQUIRE(values[4 * node + c] == around.expected(at, plane, c));
    });
    for (int i = 4 * Sch::Shape::arena_nodes; i < Sch::arena_plane; ++i) REQUIRE(values[i] == 0);
  }
}
