#pragma once
// Labelled parallel loops on the host's threads, behind two plain functions: the sources that run them need not compile Kokkos's headers.
#include <algorithm>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "core/round_up.hpp"

namespace jaxmpm {

/// Part of a loop: iterations from `begin` until before `end`, of the loop body that `body` points to.
using LoopPart = void (*)(const void* body, std::size_t begin, std::size_t end);

/// Iterations 0 … n−1, handed to threads a few at a time as they become free (dynamic), or in equal shares (static).
void run_dynamic(const std::string& label, std::size_t n, LoopPart part, const void* body);
void run_static(const std::string& label, std::size_t n, LoopPart part, const void* body);

template <class F>
void run_part(const void* body, std::size_t begin, std::size_t end) {
  const F& f = *static_cast<const F*>(body);
  for (std::size_t i = begin; i < end; ++i) f(i);
}

/// Runs f(i) for i = 0 … n−1; iterations differ in cost, so they are handed out as threads become free.
template <class F>
void parallel_for_host(const std::string& label, std::size_t n, const F& f) {
  run_dynamic(label, n, &run_part<F>, &f);
}

/// The same with equal shares for each thread, for loops over particles.
template <class F>
void parallel_for_host_static(const std::string& label, std::size_t n, const F& f) {
  run_static(label, n, &run_part<F>, &f);
}

/// f(k, begin, end) for the pieces k = 0, 1, … of 0 … n−1, side by side. They are of one size (the last may be smaller), small enough for what
/// belongs to a thousand particles to stay in the cache.
inline constexpr std::size_t piece_size = 1024;
template <class F>
void for_each_piece(const std::string& label, std::size_t n, const F& f) {
  parallel_for_host(label, pieces_of(n, piece_size), [&](std::size_t k) { f(k, k * piece_size, std::min(n, (k + 1) * piece_size)); });
}

/// f(begin, end) for each piece. The values are in order, so that what is added of them has the same bits with any number of threads.
template <class F>
auto in_pieces(const std::string& label, std::size_t n, const F& f) {
  static_assert(!std::is_same_v<decltype(f(std::size_t(0), n)), bool>, "threads cannot write bits side by side");
  std::vector<decltype(f(std::size_t(0), n))> values(pieces_of(n, piece_size));
  for_each_piece(label, n, [&](std::size_t k, std::size_t begin, std::size_t end) { values[k] = f(begin, end); });
  return values;
}

}  // namespace jaxmpm
