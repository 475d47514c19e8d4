#pragma once
// Counts rounded up: how many pieces, and to whole ones.
#include <cstddef>

namespace jaxmpm {

/// How many pieces of `size` hold n.
template <class N>
constexpr N pieces_of(N n, N size) {
  return (n + size - 1) / size;
}
/// n, rounded up to whole pieces of `size`.
template <class N>
constexpr N round_up(N n, N size) {
  return pieces_of(n, size) * size;
}

/// Bytes, rounded up to whole lines of the cache.
constexpr std::size_t whole_lines(std::size_t bytes) { return round_up(bytes, std::size_t(64)); }

}  // namespace jaxmpm
