#pragma once
// Packs and rows of values in memory: rows of particles turned to packs of one value each, and quads of nodes. They serve the transfer kernels.
#include "core/pack.hpp"

namespace jaxmpm {

/// Logarithm to base 2 of a power of two.
constexpr int log2_of(int n) { return n <= 1 ? 0 : 1 + log2_of(n / 2); }

namespace pack_detail {
/// `rounds` perfect shuffles of the lanes of C packs, seen as one deck of cards.
template <int rounds, int C, class T, int N>
JAXMPM_INLINE void perfect_shuffles(Pack<T, N>* r) {
  static_assert(C % 2 == 0);
  for (int round = 0; round < rounds; ++round) {
    Pack<T, N> t[C];
    for (int i = 0; i < C / 2; ++i) {
      t[2 * i] = interleave<0>(r[i], r[i + C / 2]);
      t[2 * i + 1] = interleave<1>(r[i], r[i + C / 2]);
    }
    for (int i = 0; i < C; ++i) r[i] = t[i];
  }
}

/// Replaces each two of C packs whose numbers differ by `apart` alone, a and b, by first(a, b) and second(a, b).
template <int C, int apart, class T, int N, class First, class Second>
JAXMPM_INLINE void join_pairs(Pack<T, N>* r, First first, Second second) {
  static_for<C / 2>([&](auto k) JAXMPM_INLINE_LAMBDA {
    constexpr int i = k / apart * 2 * apart + k % apart;
    const Pack<T, N> a = r[i], b = r[i + apart];
    r[i] = first(a, b), r[i + apart] = second(a, b);
  });
}
template <int C, int U, int apart, class T, int N>
JAXMPM_INLINE void zip_pairs(Pack<T, N>* r) {
  using P = Pack<T, N>;
  join_pairs<C, apart>(
      r, [](P a, P b) { return zip<0, U>(a, b); }, [](P a, P b) { return zip<1, U>(a, b); });
  if constexpr (apart > 1) zip_pairs<C, U, apart / 2>(r);
}
template <int C, int U, int apart, class T, int N>
JAXMPM_INLINE void unzip_pairs(Pack<T, N>* r) {
  using P = Pack<T, N>;
  join_pairs<C, apart>(
      r, [](P a, P b) { return unzip<0, U>(a, b); }, [](P a, P b) { return unzip<1, U>(a, b); });
  if constexpr (2 * apart < C) unzip_pairs<C, U, 2 * apart>(r);
}
/// Lanes of a unit of 16 bytes.
template <class T, int N>
inline constexpr int unit_lanes = 16 / int(sizeof(T)) < N ? 16 / int(sizeof(T)) : N;
}  // namespace pack_detail

/// Transposes N packs of N lanes in place.
template <class T, int N>
JAXMPM_INLINE void transpose(Pack<T, N>* r);

/// N rows of C values, one after the other in C packs, become C packs with one value of each row, in lane lane_of_row(row). Not
/// by perfect shuffles, which would do that for any C, but in steps that processors have as instructions of their own: the lanes of
/// units of 16 bytes change places with as many bits of the pack's number, then the units with the others.
template <int C, class T, int N>
JAXMPM_INLINE void rows_to_columns(Pack<T, N>* r) {
  constexpr int U = pack_detail::unit_lanes<T, N>;
  if constexpr (C > N) {  // pieces of rows, N of them at a time
    Pack<T, N> columns[C];
    for (int piece = 0; piece < C / N; ++piece) {
      for (int row = 0; row < N; ++row) columns[piece * N + row] = r[row * (C / N) + piece];
      transpose(columns + piece * N);
    }
    for (int c = 0; c < C; ++c) r[c] = columns[c];
  } else if constexpr (C < U) {
    pack_detail::perfect_shuffles<log2_of(N), C>(r);
  } else {
    if constexpr (U > 1) pack_detail::zip_pairs<C, U, U / 2>(r);
    if constexpr (U < C) pack_detail::unzip_pairs<C, U, U>(r);
  }
}
template <int C, class T, int N>
constexpr int lane_of_row(int row) {
  constexpr int U = pack_detail::unit_lanes<T, N>, rows = C < N ? N / C : 1;  // in a pack
  if (C < U || rows == 1) return row;
  return row / (U * rows) * (U * rows) + row % rows * U + row / rows % U;
}

/// The other way round, rows in their order.
template <int C, class T, int N>
JAXMPM_INLINE void columns_to_rows(Pack<T, N>* r) {
  if constexpr (C > N) {
    Pack<T, N> rows[C];
    for (int piece = 0; piece < C / N; ++piece) {
      transpose(r + piece * N);
      for (int row = 0; row < N; ++row) rows[row * (C / N) + piece] = r[piece * N + row];
    }
    for (int c = 0; c < C; ++c) r[c] = rows[c];
  } else if constexpr (C == N) {
    transpose(r);
  } else {
    pack_detail::perfect_shuffles<log2_of(C), C>(r);
  }
}

template <class T, int N>
JAXMPM_INLINE void transpose(Pack<T, N>* r) {
  rows_to_columns<N>(r);
}

/// `count` packs f(first), f(first + 1) … side by side.
template <int count, class F>
JAXMPM_INLINE auto join_packs(int first, F f) {
  if constexpr (count == 1) return f(first);
  else return join(join_packs<count / 2>(first, f), join_packs<count / 2>(first + count / 2, f));
}
/// The C values at row(l) in memory of each of N particles l become C packs with one value of each particle.
template <int C, int N, class T, class Row>
JAXMPM_INLINE void load_columns(Pack<T, N>* packs, Row row) {
  if constexpr (C >= N) {
    for (int k = 0; k < C; ++k) packs[k] = Pack<T, N>::load(row(k / (C / N)) + k % (C / N) * N);
  } else {
    for (int k = 0; k < C; ++k)
      packs[k] = join_packs<N / C>(k * (N / C), [&](int r) { return Pack<T, C>::load(row(lane_of_row<C, T, N>(r))); });
  }
  rows_to_columns<C>(packs);
}

/// Quad K of a row in memory ({r[4K] … r[4K+3]}), repeated over all lanes.
template <int K, int N, class T>
JAXMPM_INLINE Pack<T, N> repeat_quad(const T* row) {
  const auto whole = Pack<T, N>::load(row + 4 * K / N * N);
  if constexpr (N == 4) return whole;
  else return pack_detail::repeat<4 * K % N>(whole);
}

/// Part C of quad K of a row with every value four times: {r[4K+C·N/4] ×4, r[4K+C·N/4+1] ×4, …}.
template <int K, int C, int N, class T>
JAXMPM_INLINE Pack<T, N> spread_quad(const T* row) {
  constexpr int first = 4 * K + C * (N / 4);
  if constexpr (N == 4) return Pack<T, N>(row[first]);
  else return pack_detail::spread<first % N>(Pack<T, N>::load(row + first / N * N));
}

/// Adds groups of G lanes to the groups beside them, and puts what they give in `a` before what they give in `b`.
template <int G, class T, int N>
JAXMPM_INLINE Pack<T, N> fold(Pack<T, N> a, Pack<T, N> b) {
  return pack_detail::every_other<G, 0>(a, b) + pack_detail::every_other<G, G>(a, b);
}

/// Adds up the quads in each of N/4 packs and returns the sums side by side.
template <class T, int N>
JAXMPM_INLINE Pack<T, N> sum_quads(const Pack<T, N>* x) {
  if constexpr (N == 4) return x[0];
  else if constexpr (N == 8) return fold<4>(x[0], x[1]);
  else return fold<4>(fold<8>(x[0], x[1]), fold<8>(x[2], x[3]));
}

/// Adds to N/2 quads in memory: to the two values in the middle of each from one pack, to the first and the last from others.
template <class T, int N, int Half>
JAXMPM_INLINE void add_to_quads(T* at, Pack<T, N> middles, Pack<T, Half> firsts, Pack<T, Half> lasts) {
  static_assert(2 * Half == N);
  const Pack<T, N> ends = join(firsts, lasts);
  (Pack<T, N>::load(at) + pack_detail::quads<0>(middles, ends)).store(at);
  (Pack<T, N>::load(at + N) + pack_detail::quads<N>(middles, ends)).store(at + N);
}
/// Adds to one quad what is for the first of those.
template <class T, int N, int Half>
JAXMPM_INLINE void add_to_first_quad(T* at, Pack<T, N> middles, Pack<T, Half> firsts, Pack<T, Half> lasts) {
  const auto ends = join(first_lanes<2>(firsts), first_lanes<2>(lasts));
  (Pack<T, 4>::load(at) + pack_detail::quads<0>(first_lanes<4>(middles), ends)).store(at);
}

}  // namespace jaxmpm
