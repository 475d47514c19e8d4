#pragma once
// The sparse grid: blocks of B cells along each axis, of which only those with particles, and their neighbours, exist.
//
// Each tile (the particles of one body whose base node lies in one block) scatters to an arena of its own, which holds the block's nodes
// and a halo: one node below, S above, as far as stencils reach when no particle has moved more than one cell since the last sort. The grid
// update then adds, for each active block, the arenas of the neighbours in a fixed order: no atomics, and the same bits with any number of
// threads.
#include <array>
#include <cstdint>
#include <vector>

namespace jaxmpm {

template <int Dim>
using Index = std::array<int, Dim>;

/// Compile-time sizes for a dimension and a spline of S nodes.
template <int Dim, int S>
struct BlockShape {
  static constexpr int B = Dim == 2 ? 8 : 4;  // cells, and own nodes, along a block
  static constexpr int A = B + S + 1;         // nodes along an arena, from one below the block
  static constexpr int power(int x) { return Dim == 2 ? x * x : x * x * x; }
  static constexpr int cells = power(B);
  static constexpr int arena_nodes = power(A);
  /// Node 0 of block b along an axis is (b − margin)·B: ghosts and the neighbours of their blocks have non-negative coordinates as well.
  static constexpr int margin = 2;
  static constexpr int first_node(int block) { return (block - margin) * B; }
  static constexpr int neighbours = power(3);  // of a block, itself in the middle
  static_assert(S <= B, "stencils reach the next block at most");
  static constexpr int arena_node(int i, int j, int k) { return Dim == 2 ? i * A + j : (i * A + j) * A + k; }
  static constexpr int own_node(int i, int j, int k) { return Dim == 2 ? i * B + j : (i * B + j) * B + k; }
};

/// Along one axis, what the arena of the neighbour at distance d ∈ {−1, 0, 1} holds of a block's own nodes: `count` nodes from `from`, at
/// `in_arena` there.
struct Overlap {
  int from, count, in_arena;
};
template <int B, int S>
constexpr Overlap overlap(int d) {
  if (d < 0) return {0, S, B + 1};
  if (d == 0) return {0, B, 1};
  return {B - 1, 1, 0};
}

/// Particles of one body in one block, [begin, end) in the body's arrays.
struct Tile {
  std::uint32_t body, block;
  std::size_t begin, end;
};
/// An arena that reaches a block: the tile and the neighbour it lies in (0 … 3^Dim − 1).
struct Contribution {
  std::uint32_t tile, neighbour;
};

/// Active blocks in the order of their keys, the tiles, and who contributes to whom. Rebuilt at each sort.
template <int Dim>
struct Blocks {
  static constexpr int none = -1;
  std::vector<Index<Dim>> index;                  // block coordinates, see BlockShape::first_node
  std::vector<int> neighbour;                     // [block][3^Dim] active block or none
  std::vector<Tile> tiles;                        // by body, then by block
  std::vector<std::uint32_t> first_contribution;  // [block + 1]
  std::vector<Contribution> contributions;
  Index<Dim> period{};  // blocks between periodic faces, 0 along other axes: there the first block follows the last
  std::size_t count() const { return index.size(); }
};

}  // namespace jaxmpm
