#pragma once
// Sorting on a device: the same total order (block, cell, id) as state/sort.hpp. Keys, counts and the permutation stay there; the host sees
// only where the block key changes along the particles, which are nearly sorted.
#include "kernels/device/particles.hpp"
#include "state/sort.hpp"

namespace jaxmpm {

namespace device_sort {

template <class T, int Dim>
struct Keys {
  ParticleFields<T, Dim> particles;
  Index<Dim> extent;
  double base_shift;
  std::int64_t* block_key;
  std::uint32_t* cell;

  JAXMPM_INLINE void operator()(std::size_t a) const {
    using Shape = BlockShape<Dim, 2>;
    std::int64_t key = 0;
    int place = 0;
    for (int d = 0; d < Dim; ++d) {
      const int base = int(std::floor(particles.position(d, a) - base_shift)) + Shape::margin * Shape::B;  // ≥ B
      key = key * extent[std::size_t(d)] + base / Shape::B, place = place * Shape::B + base % Shape::B;
    }
    block_key[a] = key, cell[a] = std::uint32_t(place);
  }
};

/// Compacts the keys that differ from the one before.
struct Changes {
  using value_type = std::size_t;
  const std::int64_t* block_key;
  std::int64_t* change;
  JAXMPM_INLINE void operator()(std::size_t a, std::size_t& sum, bool final) const {
    if (a > 0 && block_key[a] == block_key[a - 1]) return;
    if (final) change[sum] = block_key[a];
    ++sum;
  }
};

/// Counts the particles of each slot, a cell of a filled block; cell[a] becomes the slot.
struct Count {
  const std::int64_t *filled, *block_key;
  std::size_t blocks;
  std::uint32_t cells;
  std::uint32_t *cell, *count;
  JAXMPM_INLINE void operator()(std::size_t a) const {
    std::size_t low = 0, high = blocks;  // the block is in [low, high)
    while (high - low > 1) {
      const std::size_t middle = (low + high) / 2;
      if (filled[middle] <= block_key[a]) low = middle;
      else high = middle;
    }
    cell[a] += std::uint32_t(low) * cells;
    Kokkos::atomic_fetch_add(&count[cell[a]], 1u);
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

template <class T, int Dim>
struct Permute {
  ParticleFields<T, Dim> from, to;
  const std::uint32_t* order;
  int rows;
  JAXMPM_INLINE void operator()(std::size_t a) const {
    const std::size_t b = order[a];
    for (int d = 0; d < Dim; ++d) to.position(d, a) = from.position(d, b);
    for (int k = 0; k < rows; ++k) to.row(k, a) = from.row(k, b);
    to.ids[a] = from.ids[b];
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
  /// Sorts the particles of a body and appends its tiles (with block keys in `tile_key`), as sort_particles() does.
  void sort(const Space& space, DeviceParticles<T, Dim, Space>& particles, std::uint32_t body, const Index<Dim>& extent, double base_shift,
            std::vector<Tile>& tiles, std::vector<std::int64_t>& tile_key) {
    const std::size_t n = particles.count();
    if (n == 0) return;
    grow<std::int64_t>(key_, "jaxmpm::sort", n), grow<std::int64_t>(change_, "jaxmpm::sort", n);
    grow<std::uint32_t>(slot_, "jaxmpm::sort", n), grow<std::uint32_t>(order_, "jaxmpm::sort", n);
    const ParticleFields<T, Dim> fields = particles.fields();
    parallel_for_on("jaxmpm::sort::keys", space, n, device_sort::Keys<T, Dim>{fields, extent, base_shift, key_.data(), slot_.data()});
    find_filled(space, n);
    const std::size_t blocks = filled_.size(), slots = blocks * cells;
    grow<std::uint32_t>(count_, "jaxmpm::sort", slots), grow<std::uint32_t>(start_, "jaxmpm::sort", slots);
    grow<std::uint32_t>(begin_, "jaxmpm::sort", blocks);
    Kokkos::deep_copy(space, count_, 0u);
    parallel_for_on("jaxmpm::sort::count", space, n,
                    device_sort::Count{filled_blocks_.data(), key_.data(), blocks, cells, slot_.data(), count_.data()});
    parallel_scan_on("jaxmpm::sort::starts", space, slots, device_sort::Starts{count_.data(), start_.data()});
    parallel_for_on("jaxmpm::sort::fill", space, n, device_sort::Fill{slot_.data(), start_.data(), count_.data(), order_.data()});
    parallel_for_on("jaxmpm::sort::ids", space, slots, device_sort::OrderById{start_.data(), count_.data(), fields.ids, order_.data()});
    parallel_for_on("jaxmpm::sort::permute", space, n,
                    device_sort::Permute<T, Dim>{fields, particles.spare(), order_.data(), particles.rows()});
    parallel_for_on("jaxmpm::sort::begins", space, blocks, device_sort::Begins{start_.data(), cells, begin_.data()});
    space.fence();
    particles.swap();
    std::vector<std::uint32_t> begin(blocks + 1, std::uint32_t(n));
    copy_out(begin.data(), begin_, 0, blocks);
    for (std::size_t b = 0; b < blocks; ++b) tiles.push_back({body, 0, begin[b], begin[b + 1]}), tile_key.push_back(filled_[b]);
  }

 private:
  static constexpr std::uint32_t cells = std::uint32_t(BlockShape<Dim, 2>::cells);

  /// The block keys that occur, ascending, on the host and the device.
  void find_filled(const Space& space, std::size_t n) {
    filled_.resize(parallel_scan_on("jaxmpm::sort::changes", space, n, device_sort::Changes{key_.data(), change_.data()}));
    copy_out(filled_.data(), change_, 0, filled_.size());
    std::sort(filled_.begin(), filled_.end());
    filled_.erase(std::unique(filled_.begin(), filled_.end()), filled_.end());
    mirror(filled_blocks_, "jaxmpm::sort", filled_);
  }

  DeviceArray<std::int64_t, Space> key_, change_, filled_blocks_;
  DeviceArray<std::uint32_t, Space> slot_, order_, count_, start_, begin_;
  std::vector<std::int64_t> filled_;
};

}  // namespace jaxmpm
