#pragma once
// The sums at the nodes of all blocks, without the nodes that nothing reaches: half of a grid's, where blocks hold free surfaces, and the
// memory that a state takes decides how long a reverse run does.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/pack.hpp"
#include "core/parallel_host.hpp"
#include "core/round_up.hpp"

namespace jaxmpm {

/// In memory: for each block a mask of its nodes (bit n: node n is there), then from the next line of the cache on the quads of those nodes,
/// block after block, plane after plane.
template <class T>
class PackedSums {
 public:
  static constexpr std::size_t cells = 64;  // of a block, in 2D and in 3D

  explicit PackedSums(int planes) : planes_(std::size_t(planes)) {}
  /// Room for the sums of so many blocks, whatever is there.
  std::size_t most_bytes(std::size_t blocks) const { return masks_bytes(blocks) + blocks * planes_ * cells * 4 * sizeof(T); }

  /// Makes ready for so many blocks, each of which is then to be shown to look_at().
  void begin(std::size_t blocks) { masks_.resize(blocks); }
  /// Which nodes of block b are there. `sums`: [plane][node][4].
  void look_at(std::size_t b, const T* sums) {
    std::uint64_t mask = 0;
    for (std::size_t node = 0; node < cells; ++node) {
      bool some = is_there(sums + 4 * node);
      if (planes_ == 2) some = some || is_there(sums + 4 * (cells + node));
      mask |= std::uint64_t(some) << node;
    }
    masks_[b] = mask;
  }
  /// sums(b): those that block b had when it was looked at.
  template <class Sums>
  void pack(const Sums& sums, std::byte* to) {
    std::memcpy(to, masks_.data(), masks_.size() * sizeof(masks_[0]));
    place();
    T* quads = reinterpret_cast<T*>(to + masks_bytes(masks_.size()));
    parallel_for_host_static("jaxmpm::pack_sums", masks_.size(), [&](std::size_t b) {
      const T* from = sums(b);
      T* at = quads + first_[b];
      if (masks_[b] == full) std::memcpy(at, from, block_bytes());
      else for_each_quad(b, [&](std::size_t quad) { Quad::load(from + 4 * quad).store(at), at += 4; });
    });
  }

  /// Gets ready to unpack what pack() wrote.
  void open(std::size_t blocks, const std::byte* from) {
    masks_.resize(blocks);
    std::memcpy(masks_.data(), from, blocks * sizeof(masks_[0]));
    place();
    quads_ = reinterpret_cast<const T*>(from + masks_bytes(blocks));
  }
  /// The sums of block b.
  void unpack(std::size_t b, T* to) const {
    const T* at = quads_ + first_[b];
    if (masks_[b] == full) {
      std::memcpy(to, at, block_bytes());
      return;
    }
    std::memset(to, 0, block_bytes());
    for_each_quad(b, [&](std::size_t quad) { Quad::load(at).store(to + 4 * quad), at += 4; });
  }

 private:
  using Quad = Pack<T, 4>;
  static constexpr std::uint64_t full = ~std::uint64_t(0);

  static std::size_t masks_bytes(std::size_t blocks) { return whole_lines(blocks * sizeof(std::uint64_t)); }
  std::size_t block_bytes() const { return planes_ * cells * 4 * sizeof(T); }
  /// A node without mass may have an impulse: the slopes of linear splines do not vanish where the splines do.
  static bool is_there(const T* quad) { return quad[0] != T(0) || quad[1] != T(0) || quad[2] != T(0) || quad[3] != T(0); }
  /// Calls f(place among a block's quads) for those that are there.
  template <class F>
  void for_each_quad(std::size_t b, const F& f) const {
    for (std::size_t plane = 0; plane < planes_; ++plane)
      for (std::uint64_t left = masks_[b]; left != 0; left &= left - 1) f(plane * cells + std::size_t(__builtin_ctzll(left)));
  }
  /// Where each block's quads begin.
  void place() {
    first_.resize(masks_.size());
    std::size_t at = 0;
    for (std::size_t b = 0; b < masks_.size(); ++b) first_[b] = at, at += 4 * planes_ * std::size_t(__builtin_popcountll(masks_[b]));
  }

  std::size_t planes_;
  std::vector<std::uint64_t> masks_;
  std::vector<std::size_t> first_;
  const T* quads_ = nullptr;
};

}  // namespace jaxmpm
