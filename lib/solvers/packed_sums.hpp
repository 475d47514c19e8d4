#pragma once
// The sums at the nodes of all blocks, without the nodes that nothing reaches: half of a grid's, where blocks hold free surfaces, and the
// memory that a state takes decides how long a reverse run does.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/pack.hpp"
#include "core/parallel_host.hpp"

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

  /// sums(b): those of block b, [plane][node][4].
  template <class Sums>
  void pack(std::size_t blocks, const Sums& sums, std::byte* to) {
    masks_.resize(blocks);
    parallel_for_host_static("jaxmpm::mask_sums", blocks, [&](std::size_t b) { masks_[b] = mask_of(sums(b)); });
    std::memcpy(to, masks_.data(), blocks * sizeof(masks_[0]));
    place(blocks);
    T* quads = reinterpret_cast<T*>(to + masks_bytes(blocks));
    parallel_for_host_static("jaxmpm::pack_sums", blocks, [&](std::size_t b) {
      const T* from = sums(b);
      T* at = quads + first_[b];
      for (std::size_t plane = 0; plane < planes_; ++plane)
        for (std::uint64_t left = masks_[b]; left != 0; left &= left - 1, at += 4)
          Quad::load(from + 4 * (plane * cells + std::size_t(__builtin_ctzll(left)))).store(at);
    });
  }

  /// Gets ready to unpack what pack() wrote.
  void open(std::size_t blocks, const std::byte* from) {
    masks_.resize(blocks);
    std::memcpy(masks_.data(), from, blocks * sizeof(masks_[0]));
    place(blocks);
    quads_ = reinterpret_cast<const T*>(from + masks_bytes(blocks));
  }
  /// The sums of block b.
  void unpack(std::size_t b, T* to) const {
    const T* at = quads_ + first_[b];
    std::memset(to, 0, planes_ * cells * 4 * sizeof(T));
    for (std::size_t plane = 0; plane < planes_; ++plane)
      for (std::uint64_t left = masks_[b]; left != 0; left &= left - 1, at += 4)
        Quad::load(at).store(to + 4 * (plane * cells + std::size_t(__builtin_ctzll(left))));
  }

 private:
  using Quad = Pack<T, 4>;

  static std::size_t masks_bytes(std::size_t blocks) {
    constexpr std::size_t line = 64;
    return (blocks * sizeof(std::uint64_t) + line - 1) / line * line;
  }
  std::uint64_t mask_of(const T* sums) const {
    std::uint64_t mask = 0;
    for (std::size_t node = 0; node < cells; ++node) {
      auto some = Quad::load(sums + 4 * node) != Quad(T(0));
      if (planes_ == 2) some = some | (Quad::load(sums + 4 * (cells + node)) != Quad(T(0)));
      mask |= std::uint64_t(any(some)) << node;
    }
    return mask;
  }
  /// Where each block's quads begin.
  void place(std::size_t blocks) {
    first_.resize(blocks);
    std::size_t at = 0;
    for (std::size_t b = 0; b < blocks; ++b) first_[b] = at, at += 4 * planes_ * std::size_t(__builtin_popcountll(masks_[b]));
  }

  std::size_t planes_;
  std::vector<std::uint64_t> masks_;
  std::vector<std::size_t> first_;
  const T* quads_ = nullptr;
};

}  // namespace jaxmpm
