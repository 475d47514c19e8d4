#pragma once
// Sorting: particles by block, cell and id (a total order, so that the bits do not depend on history), and the blocks that follow from it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "basis/bspline.hpp"
#include "core/parallel_host.hpp"
#include "core/round_up.hpp"
#include "state/blocks.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Keys and scratch that live from sort to sort, so that sorting allocates nothing in the long run.
template <class T>
struct SortScratch {
  std::vector<std::int64_t> block_key;
  std::vector<std::uint16_t> cell;
  std::vector<std::uint32_t> order, next;
  std::vector<std::int64_t> filled;  // distinct block keys of a body, ascending
  Array<double> f8;
  Array<T> real;
  Array<std::uint32_t> u4;
};

/// Block coordinates along each axis of a domain of `cells` cells, margins included.
template <int Dim, int S>
Index<Dim> block_extent(const std::array<int, 3>& cells) {
  Index<Dim> n{};
  for (int d = 0; d < Dim; ++d)
    n[std::size_t(d)] = (cells[std::size_t(d)] + S) / BlockShape<Dim, S>::B + 2 * BlockShape<Dim, S>::margin + 1;
  return n;
}

namespace sort_detail {

/// Distinct values of a nearly sorted sequence, ascending.
inline void distinct(const std::vector<std::int64_t>& keys, std::vector<std::int64_t>& out) {
  out.clear();
  for (std::size_t a = 0; a < keys.size(); ++a)
    if (a == 0 || keys[a] != keys[a - 1]) out.push_back(keys[a]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

template <class From>
void permute(Array<From>& field, Array<From>& scratch, const std::vector<std::uint32_t>& order) {
  scratch.resize(field.size());
  parallel_for_host_static("jaxmpm::sort::permute", field.size(), [&](std::size_t a) { scratch[a] = field[order[a]]; });
  field.swap(scratch);
}

}  // namespace sort_detail

/// Sorts the particles of one body and appends its tiles (with block keys in `tile_key`).
template <int S, class T, int Dim>
void sort_particles(Particles<T, Dim>& particles, std::uint32_t body, const Index<Dim>& extent, SortScratch<T>& scratch,
                    std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key) {
  using Shape = BlockShape<Dim, S>;
  constexpr int B = Shape::B;
  const std::size_t n = particles.count();
  scratch.block_key.resize(n), scratch.cell.resize(n), scratch.order.resize(n);
  parallel_for_host_static("jaxmpm::sort::keys", n, [&](std::size_t a) {
    std::int64_t key = 0;
    int cell = 0;
    for (int d = 0; d < Dim; ++d) {
      const int base = int(std::floor(particles.position[std::size_t(d)][a] - Bspline<S>::base_shift)) + Shape::margin * B;  // ≥ B
      key = key * extent[std::size_t(d)] + base / B, cell = cell * B + base % B;
    }
    scratch.block_key[a] = key, scratch.cell[a] = std::uint16_t(cell);
  });
  sort_detail::distinct(scratch.block_key, scratch.filled);
  const std::vector<std::int64_t>& filled = scratch.filled;
  std::vector<std::uint32_t>& next = scratch.next;  // counting sort over (rank of block, cell)
  next.assign(filled.size() * Shape::cells + 1, 0);
  std::size_t rank = 0;
  const auto slot = [&](std::size_t a) {
    if (filled[rank] != scratch.block_key[a])
      rank = std::size_t(std::lower_bound(filled.begin(), filled.end(), scratch.block_key[a]) - filled.begin());
    return rank * Shape::cells + scratch.cell[a];
  };
  for (std::size_t a = 0; a < n; ++a) ++next[slot(a) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t r = 0; r < filled.size(); ++r) {
    tiles.push_back({body, 0, next[r * Shape::cells], next[(r + 1) * Shape::cells]});
    tile_key.push_back(filled[r]);
  }
  for (std::size_t a = 0; a < n; ++a) scratch.order[next[slot(a)]++] = std::uint32_t(a);
  // Now next[c] is where cell c ends.
  parallel_for_host_static("jaxmpm::sort::ids", filled.size() * Shape::cells, [&](std::size_t c) {
    const auto by_id = [&](std::uint32_t a, std::uint32_t b) { return particles.id[a] < particles.id[b]; };
    std::sort(scratch.order.begin() + (c == 0 ? 0 : next[c - 1]), scratch.order.begin() + next[c], by_id);
  });
  particles.for_each_field([&](const std::string&, auto& field) {
    using Value = std::decay_t<decltype(field[0])>;
    if constexpr (std::is_same_v<Value, T>) sort_detail::permute(field, scratch.real, scratch.order);
    else if constexpr (std::is_same_v<Value, double>) sort_detail::permute(field, scratch.f8, scratch.order);
    else sort_detail::permute(field, scratch.u4, scratch.order);
  });
}

namespace sort_detail {

/// Distance of the keys of neighbouring blocks along each axis.
template <int Dim>
std::array<std::int64_t, Dim> key_strides(const Index<Dim>& extent) {
  std::array<std::int64_t, Dim> stride{};
  stride[Dim - 1] = 1;
  for (int d = Dim - 2; d >= 0; --d) stride[std::size_t(d)] = stride[std::size_t(d) + 1] * extent[std::size_t(d) + 1];
  return stride;
}

/// The keys with those before and behind them at a distance: three ascending sequences in one.
inline std::vector<std::int64_t> with_both_sides(const std::vector<std::int64_t>& keys, std::int64_t distance) {
  constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> all;
  all.reserve(keys.size() * 2);
  std::array<std::size_t, 3> at{};
  const auto next = [&](std::size_t k) { return at[k] < keys.size() ? keys[at[k]] + (std::int64_t(k) - 1) * distance : end; };
  for (std::int64_t least; (least = std::min({next(0), next(1), next(2)})) != end; all.push_back(least))
    for (std::size_t k = 0; k < 3; ++k) at[k] += next(k) == least;
  return all;
}

}  // namespace sort_detail

/// The block of a key.
template <int Dim>
Index<Dim> block_of_key(std::int64_t key, const Index<Dim>& extent) {
  Index<Dim> block{};
  for (std::size_t d = Dim; d-- > 0; key /= extent[d]) block[d] = int(key % extent[d]);
  return block;
}

/// The key of a block, ascending along the last axis first.
template <int Dim>
std::int64_t block_key(const Index<Dim>& block, const Index<Dim>& extent) {
  std::int64_t key = 0;
  for (std::size_t d = 0; d < Dim; ++d) key = key * extent[d] + block[d];
  return key;
}

/// A block's neighbour at a distance (−1, 0, 1 along each axis, as `m` numbers them), across periodic faces too.
template <int Dim>
Index<Dim> neighbour_of(const Index<Dim>& block, std::size_t m, const Index<Dim>& period, int margin) {
  Index<Dim> other = block;
  for (std::size_t d = Dim; d-- > 0; m /= 3) {
    other[d] += int(m % 3) - 1;
    if (period[d] > 0) other[d] = margin + (other[d] - margin + period[d]) % period[d];
  }
  return other;
}

/// Keys of the blocks of `keys` and of all around them, ascending, where some faces are periodic.
template <int Dim>
std::vector<std::int64_t> with_neighbours(const std::vector<std::int64_t>& keys, const Index<Dim>& extent, const Index<Dim>& period,
                                          std::size_t around, int margin) {
  std::vector<std::int64_t> all;
  for (const std::int64_t key : keys)
    for (std::size_t m = 0; m < around; ++m)
      all.push_back(block_key<Dim>(neighbour_of<Dim>(block_of_key<Dim>(key, extent), m, period, margin), extent));
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Active blocks, neighbours and contributions of the tiles that sort_particles made.
template <int S, int Dim>
void build_blocks(Blocks<Dim>& blocks, const std::vector<std::int64_t>& tile_key, const Index<Dim>& extent) {
  constexpr std::size_t around = BlockShape<Dim, S>::neighbours;
  const std::array<std::int64_t, Dim> stride = sort_detail::key_strides<Dim>(extent);
  std::vector<std::int64_t> keys = tile_key;
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  const bool periodic = blocks.period != Index<Dim>{};
  if (periodic) keys = with_neighbours<Dim>(keys, extent, blocks.period, around, BlockShape<Dim, S>::margin);
  else
    for (const std::int64_t distance : stride) keys = sort_detail::with_both_sides(keys, distance);

  const std::size_t n = keys.size();
  blocks.index.resize(n), blocks.neighbour.assign(n * around, Blocks<Dim>::none);
  for (std::size_t b = 0; b < n; ++b) blocks.index[b] = block_of_key<Dim>(keys[b], extent);
  constexpr std::size_t share = 1024;  // blocks side by side: threads that wrote by turns would fight over the memory's lines
  parallel_for_host("jaxmpm::blocks", pieces_of(n, share), [&](std::size_t part) {
    const std::size_t first = part * share, last = std::min(first + share, n);
    for (std::size_t m = 0; periodic && m < around; ++m)
      for (std::size_t b = first; b < last; ++b) {
        const std::int64_t key = block_key<Dim>(neighbour_of<Dim>(blocks.index[b], m, blocks.period, BlockShape<Dim, S>::margin), extent);
        const auto other = std::lower_bound(keys.begin(), keys.end(), key);
        if (other != keys.end() && *other == key) blocks.neighbour[b * around + m] = int(other - keys.begin());
      }
    for (std::size_t m = 0; !periodic && m < around; ++m) {  // of neighbour m = (a·3 + b)·3 + c
      std::int64_t offset = 0;
      for (std::size_t d = Dim, rest = m; d-- > 0; rest /= 3) offset += (std::int64_t(rest % 3) - 1) * stride[d];
      auto other = std::lower_bound(keys.begin(), keys.end(), keys[first] + offset);
      for (std::size_t b = first; b < last; ++b) {  // both ascend
        while (other != keys.end() && *other < keys[b] + offset) ++other;
        if (other != keys.end() && *other == keys[b] + offset) blocks.neighbour[b * around + m] = int(other - keys.begin());
      }
    }
  });

  std::vector<std::uint32_t> first_of(n + 1, 0), tile_of(tile_key.size());  // the tiles of each block, by body
  for (std::size_t t = 0; t < tile_key.size(); ++t) {
    blocks.tiles[t].block = std::uint32_t(std::lower_bound(keys.begin(), keys.end(), tile_key[t]) - keys.begin());
    ++first_of[blocks.tiles[t].block + 1];
  }
  std::partial_sum(first_of.begin(), first_of.end(), first_of.begin());
  std::vector<std::uint32_t> next(first_of.begin(), first_of.end() - 1);
  for (std::size_t t = 0; t < tile_key.size(); ++t) tile_of[next[blocks.tiles[t].block]++] = std::uint32_t(t);
  blocks.first_contribution.assign(1, 0), blocks.contributions.clear();
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t m = 0; m < around; ++m) {
      const int other = blocks.neighbour[b * around + m];
      if (other < 0) continue;
      for (std::uint32_t k = first_of[std::size_t(other)]; k < first_of[std::size_t(other) + 1]; ++k)
        blocks.contributions.push_back({tile_of[k], std::uint32_t(m)});
    }
    blocks.first_contribution.push_back(std::uint32_t(blocks.contributions.size()));
  }
}

}  // namespace jaxmpm
