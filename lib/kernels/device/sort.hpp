#pragma once
// Sorting on a device: the same total order (block, cell, id) as state/sort.hpp. A particle moves less than a block between two sorts, so
// each tile's particles go to the blocks around it, which the grid of the last sort already has; the host sees only which of them are
// filled.
#include "kernels/device/stencil.hpp"
#include "state/sort.hpp"

namespace jaxmpm {

namespace device_sort {

/// The tiles of one body, and the grid, of the last sort.
template <int Dim>
struct Known {
  const Tile* tiles;
  const Index<Dim>* block_index;  // [block]
  const int* neighbour;           // [block][3^Dim]
  static constexpr int around = BlockShape<Dim, 2>::neighbours, cells = BlockShape<Dim, 2>::cells;
};

/// Where each particle has gone: code = neighbour · cells + cell. Marks the neighbours that a tile's particles have reached in a bit each
/// of moves[tile]; bit `far` says that one went further than that.
inline constexpr int far = 31;
template <class T, int Dim, class Space>
struct FindMoves {
  ParticleFields<T, Dim> particles;
  Known<Dim> known;
  double base_shift;
  std::uint16_t* code;
  unsigned* moves;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const Tile tile = known.tiles[team.league_rank()];
    const Index<Dim> first = first_node<Dim>(known.block_index[tile.block]);
    unsigned reached = 0;
    team_for(team, int(tile.end - tile.begin), [&](int i) {
      constexpr int B = BlockShape<Dim, 2>::B;
      const std::size_t p = tile.begin + std::size_t(i);
      int neighbour = 0, cell = 0;
      bool near = true;
      for (int d = 0; d < Dim; ++d) {
        const int local = int(std::floor(particles.position(d, p) - base_shift)) - first[std::size_t(d)] + B;  // in three blocks
        near = near && local >= 0 && local < 3 * B;
        neighbour = neighbour * 3 + local / B, cell = cell * B + local % B;
      }
      reached |= near ? 1u << neighbour : 1u << far;
      code[p] = near ? std::uint16_t(neighbour * Known<Dim>::cells + cell) : std::uint16_t(0);
    });
    if (reached) Kokkos::atomic_fetch_or(moves + team.league_rank(), reached);
  }
};

/// Counts the particles of each slot, a cell of a filled block; slot[p] is the particle's.
template <int Dim, class Space>
struct Count {
  Known<Dim> known;
  const std::uint16_t* code;
  const int* rank;  // [block of the last sort] among the filled ones
  std::uint32_t *slot, *count;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const Tile tile = known.tiles[team.league_rank()];
    const int* around = known.neighbour + std::size_t(tile.block) * Known<Dim>::around;
    team_for(team, int(tile.end - tile.begin), [&](int i) {
      const std::size_t p = tile.begin + std::size_t(i);
      const std::uint32_t cells = Known<Dim>::cells, cell = code[p] % cells;
      slot[p] = std::uint32_t(rank[around[code[p] / cells]]) * cells + cell;
      Kokkos::atomic_fetch_add(&count[slot[p]], 1u);
    });
  }
};

/// start[slot]: particles in the slots before; the counts become zero again.
struct Starts {
  using value_type = std::uint32_t;
  std::uint32_t *count, *start;
  JAXMPM_INLINE void operator()(std::size_t slot, std::uint32_t& sum, bool final) const {
    const std::uint32_t n = count[slot];
    if (final) start[slot] = sum, count[slot] = 0;
    sum += n;
  }
};

struct Fill {
  const std::uint32_t *slot, *start;
  std::uint32_t *filled, *order;
  JAXMPM_INLINE void operator()(std::size_t a) const {
    order[start[slot[a]] + Kokkos::atomic_fetch_add(&filled[slot[a]], 1u)] = std::uint32_t(a);
  }
};

/// Puts the few particles of a slot in the order of their ids: Fill leaves them in any.
struct OrderById {
  const std::uint32_t *start, *count, *id;
  std::uint32_t* order;
  JAXMPM_INLINE void operator()(std::size_t slot) const {
    std::uint32_t* first = order + start[slot];
    for (std::uint32_t i = 1; i < count[slot]; ++i) {
      const std::uint32_t a = first[i];
      std::uint32_t j = i;
      for (; j > 0 && id[first[j - 1]] > id[a]; --j) first[j] = first[j - 1];
      first[j] = a;
    }
  }
};

/// Where each filled block's particles begin.
struct Begins {
  const std::uint32_t* start;
  std::uint32_t cells;
  std::uint32_t* begin;
  JAXMPM_INLINE void operator()(std::size_t block) const { begin[block] = start[block * cells]; }
};

}  // namespace device_sort

/// Sorts bodies one after another; its arrays live from sort to sort.
template <class T, int Dim, class Space>
class DeviceSort {
 public:
  using Known = device_sort::Known<Dim>;

  /// Sorts the particles of a body, whose tiles begin at `first_tile` of `blocks`, the grid of the last sort (`known`: in the device's
  /// memory). Appends the new tiles, and the blocks of the last sort that they lie in. False where a particle has gone too far for that:
  /// nothing is changed then.
  bool sort(const Space& space, DeviceParticles<T, Dim, Space>& particles, std::uint32_t body, const Blocks<Dim>& blocks,
            std::size_t first_tile, std::size_t tile_count, const Known& known, double base_shift, std::vector<Tile>& tiles,
            std::vector<std::uint32_t>& tile_block) {
    const std::size_t n = particles.count();
    if (n == 0) return true;
    grow<std::uint16_t>(code_, "jaxmpm::sort", n), grow<unsigned>(moves_, "jaxmpm::sort", tile_count);
    grow<std::uint32_t>(slot_, "jaxmpm::sort", n), grow<std::uint32_t>(order_, "jaxmpm::sort", n);
    Kokkos::deep_copy(space, moves_, 0u);
    parallel_for_teams<sort_threads, 0>(
        "jaxmpm::sort::moves", space, tile_count, 0,
        device_sort::FindMoves<T, Dim, Space>{particles.fields(), known, base_shift, code_.data(), moves_.data()});
    if (!find_filled(space, blocks, first_tile, tile_count)) return false;
    const std::size_t filled = filled_.size(), slots = filled * cells;
    grow<std::uint32_t>(count_, "jaxmpm::sort", slots), grow<std::uint32_t>(start_, "jaxmpm::sort", slots);
    grow<std::uint32_t>(begin_, "jaxmpm::sort", filled);
    Kokkos::deep_copy(space, count_, 0u);
    parallel_for_teams<sort_threads, 0>("jaxmpm::sort::count", space, tile_count, 0,
                                        device_sort::Count<Dim, Space>{known, code_.data(), rank_.data(), slot_.data(), count_.data()});
    parallel_scan_on("jaxmpm::sort::starts", space, slots, device_sort::Starts{count_.data(), start_.data()});
    parallel_for_on("jaxmpm::sort::fill", space, n, device_sort::Fill{slot_.data(), start_.data(), count_.data(), order_.data()});
    const ParticleFields<T, Dim> fields = particles.fields();
    parallel_for_on("jaxmpm::sort::ids", space, slots, device_sort::OrderById{start_.data(), count_.data(), fields.ids, order_.data()});
    parallel_for_on("jaxmpm::sort::permute", space, n, Permute<T, Dim>{fields, particles.spare(), order_.data(), particles.rows()});
    parallel_for_on("jaxmpm::sort::begins", space, filled, device_sort::Begins{start_.data(), cells, begin_.data()});
    space.fence();
    particles.swap();
    std::vector<std::uint32_t> begin(filled + 1, std::uint32_t(n));
    copy_out(begin.data(), begin_, 0, filled);
    for (std::size_t b = 0; b < filled; ++b) tiles.push_back({body, 0, begin[b], begin[b + 1]}), tile_block.push_back(filled_[b]);
    return true;
  }

 private:
  static constexpr std::uint32_t cells = std::uint32_t(BlockShape<Dim, 2>::cells);
  static constexpr int sort_threads = 128;

  /// The blocks of the last sort that now have particles, ascending, and each block's rank among them. False where particles went too far.
  bool find_filled(const Space& space, const Blocks<Dim>& blocks, std::size_t first_tile, std::size_t tile_count) {
    space.fence();
    std::vector<unsigned> moves(tile_count);
    copy_out(moves.data(), moves_, 0, tile_count);
    std::vector<int> rank(blocks.count(), -1);
    for (std::size_t t = 0; t < tile_count; ++t) {
      if (moves[t] >> device_sort::far) return false;
      const int* around = &blocks.neighbour[std::size_t(blocks.tiles[first_tile + t].block) * Known::around];
      for (int m = 0; m < Known::around; ++m)
        if (moves[t] >> m & 1) rank[std::size_t(around[m])] = 0;
    }
    filled_.clear();
    for (std::size_t b = 0; b < rank.size(); ++b)
      if (rank[b] == 0) rank[b] = int(filled_.size()), filled_.push_back(std::uint32_t(b));
    mirror(rank_, "jaxmpm::sort", rank);
    return true;
  }

  DeviceArray<std::uint16_t, Space> code_;
  DeviceArray<unsigned, Space> moves_;
  DeviceArray<int, Space> rank_;
  DeviceArray<std::uint32_t, Space> slot_, order_, count_, start_, begin_;
  std::vector<std::uint32_t> filled_;
};

}  // namespace jaxmpm
