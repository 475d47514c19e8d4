#pragma once
// Portable SIMD: a pack of N lanes on the compiler's own vector type, so that g++ and nvcc (host side) both take it. Widths 2 to 16.
// Packs behave as scalars (see tensor.hpp); comparisons give a Mask for select(). Rows and transposes serve the transfer kernels.
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/macros.hpp"

namespace jaxmpm {

#if defined(__AVX512F__)
inline constexpr int native_bytes = 64;
#elif defined(__AVX__)
inline constexpr int native_bytes = 32;
#else
inline constexpr int native_bytes = 16;
#endif
/// Lanes of T in the widest vector register that this build may use, but four at least: a node's values take so many.
template <class T>
inline constexpr int native_lanes = native_bytes / int(sizeof(T)) < 4 ? 4 : native_bytes / int(sizeof(T));

namespace pack_detail {
// Written out, as compilers lose the attribute where its size depends on a template parameter.
template <class T, int N>
struct Register;  // type: in a register; place: anywhere in memory among values of T
#define JAXMPM_REGISTER(T, N)                                                                    \
  template <>                                                                                    \
  struct Register<T, N> {                                                                        \
    typedef T type __attribute__((vector_size(N * sizeof(T))));                                  \
    typedef T place __attribute__((vector_size(N * sizeof(T)), aligned(alignof(T)), may_alias)); \
  };
#define JAXMPM_REGISTERS(T) JAXMPM_REGISTER(T, 2) JAXMPM_REGISTER(T, 4) JAXMPM_REGISTER(T, 8) JAXMPM_REGISTER(T, 16)
JAXMPM_REGISTERS(float)
JAXMPM_REGISTERS(double)
JAXMPM_REGISTERS(int)
JAXMPM_REGISTERS(long)
#undef JAXMPM_REGISTERS
#undef JAXMPM_REGISTER
}  // namespace pack_detail

template <class T, int N>
struct Mask {
  using Lane = std::conditional_t<sizeof(T) == 4, int, long>;
  using Native = typename pack_detail::Register<Lane, N>::type;
  Native m;
  friend JAXMPM_INLINE Mask operator&(Mask a, Mask b) { return {a.m & b.m}; }
  friend JAXMPM_INLINE Mask operator|(Mask a, Mask b) { return {a.m | b.m}; }
  friend JAXMPM_INLINE Mask operator&&(Mask a, Mask b) { return {a.m & b.m}; }
  friend JAXMPM_INLINE Mask operator||(Mask a, Mask b) { return {a.m | b.m}; }
  friend JAXMPM_INLINE Mask operator!(Mask a) { return {~a.m}; }
};

template <class T, int N>
struct Pack {
  using Native = typename pack_detail::Register<T, N>::type;
  using Place = typename pack_detail::Register<T, N>::place;
  using Scalar = T;
  static constexpr int lanes = N;
  Native v;

  Pack() = default;
  JAXMPM_INLINE Pack(T s) : v(s - Native{}) {}  // all lanes alike
  JAXMPM_INLINE explicit Pack(Native n) : v(n) {}
  JAXMPM_INLINE T operator[](int lane) const { return v[lane]; }

  // One move each. Copies by memcpy are in pieces of 16 or 32 bytes, and a load of what was stored in smaller pieces waits for the memory.
  static JAXMPM_INLINE Pack load(const T* p) { return Pack(Native(*reinterpret_cast<const Place*>(p))); }
  JAXMPM_INLINE void store(T* p) const { *reinterpret_cast<Place*>(p) = v; }

  friend JAXMPM_INLINE Pack operator+(Pack a, Pack b) { return Pack(a.v + b.v); }
  friend JAXMPM_INLINE Pack operator-(Pack a, Pack b) { return Pack(a.v - b.v); }
  friend JAXMPM_INLINE Pack operator*(Pack a, Pack b) { return Pack(a.v * b.v); }
  friend JAXMPM_INLINE Pack operator/(Pack a, Pack b) { return Pack(a.v / b.v); }
  friend JAXMPM_INLINE Pack operator-(Pack a) { return Pack(-a.v); }
  JAXMPM_INLINE Pack& operator+=(Pack b) { return v += b.v, *this; }
  JAXMPM_INLINE Pack& operator-=(Pack b) { return v -= b.v, *this; }
  JAXMPM_INLINE Pack& operator*=(Pack b) { return v *= b.v, *this; }
  JAXMPM_INLINE Pack& operator/=(Pack b) { return v /= b.v, *this; }

  friend JAXMPM_INLINE Mask<T, N> operator<(Pack a, Pack b) { return {a.v < b.v}; }
  friend JAXMPM_INLINE Mask<T, N> operator>(Pack a, Pack b) { return {a.v > b.v}; }
  friend JAXMPM_INLINE Mask<T, N> operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
  friend JAXMPM_INLINE Mask<T, N> operator>=(Pack a, Pack b) { return {a.v >= b.v}; }
  friend JAXMPM_INLINE Mask<T, N> operator==(Pack a, Pack b) { return {a.v == b.v}; }
  friend JAXMPM_INLINE Mask<T, N> operator!=(Pack a, Pack b) { return {a.v != b.v}; }

  friend JAXMPM_INLINE Pack select(Mask<T, N> c, Pack a, Pack b) { return Pack(c.m ? a.v : b.v); }
  friend JAXMPM_INLINE Pack max(Pack a, Pack b) { return Pack(a.v < b.v ? b.v : a.v); }  // of NaN: as in scalar.hpp
  friend JAXMPM_INLINE Pack min(Pack a, Pack b) { return Pack(b.v < a.v ? b.v : a.v); }
  friend JAXMPM_INLINE Pack abs(Pack a) { return max(a, -a); }

  /// Lane by lane through memory: the compiler turns the loop into vector instructions where there are some.
  template <class F>
  JAXMPM_INLINE Pack map(F f) const {
    alignas(sizeof(Native)) T lane[N];
    store(lane);
    for (int i = 0; i < N; ++i) lane[i] = f(lane[i]);
    return load(lane);
  }
  friend JAXMPM_INLINE Pack floor(Pack a) {
    return a.map([](T x) { return std::floor(x); });
  }
  friend JAXMPM_INLINE Pack sqrt(Pack a) {
    return a.map([](T x) { return std::sqrt(x); });
  }
  friend JAXMPM_INLINE Pack log(Pack a) {
    return a.map([](T x) { return std::log(x); });
  }
  friend JAXMPM_INLINE Pack log1p(Pack a) {
    return a.map([](T x) { return std::log1p(x); });
  }
  friend JAXMPM_INLINE Pack exp(Pack a) {
    return a.map([](T x) { return std::exp(x); });
  }
};

/// Calls f(integral_constant 0) … f(integral_constant N−1): a loop whose index is known at compile time.
template <class F, int... I>
JAXMPM_INLINE void static_for(std::integer_sequence<int, I...>, F&& f) {
  (f(std::integral_constant<int, I>{}), ...);
}
template <int N, class F>
JAXMPM_INLINE void static_for(F&& f) {
  static_for(std::make_integer_sequence<int, N>{}, f);
}

namespace pack_detail {
// Shuffles of a and b, lane(i) being where lane i comes from (0 … N−1: a, N … 2N−1: b). The lanes are written out, as nvcc's host side
// loses the expansion of a parameter pack in the compiler's own function.
#define JAXMPM_LANES_2(lane, i) lane(i), lane(i + 1)
#define JAXMPM_LANES_4(lane, i) JAXMPM_LANES_2(lane, i), JAXMPM_LANES_2(lane, i + 2)
#define JAXMPM_LANES_8(lane, i) JAXMPM_LANES_4(lane, i), JAXMPM_LANES_4(lane, i + 4)
#define JAXMPM_LANES_16(lane, i) JAXMPM_LANES_8(lane, i), JAXMPM_LANES_8(lane, i + 8)
#define JAXMPM_SHUFFLE(a, b, lane)                                                                          \
  if constexpr (N == 2) return Pack<T, N>(__builtin_shufflevector(a.v, b.v, JAXMPM_LANES_2(lane, 0)));      \
  else if constexpr (N == 4) return Pack<T, N>(__builtin_shufflevector(a.v, b.v, JAXMPM_LANES_4(lane, 0))); \
  else if constexpr (N == 8) return Pack<T, N>(__builtin_shufflevector(a.v, b.v, JAXMPM_LANES_8(lane, 0))); \
  else return Pack<T, N>(__builtin_shufflevector(a.v, b.v, JAXMPM_LANES_16(lane, 0)));
#define JAXMPM_INTERLEAVED(i) (Half * (N / 2) + (i) / 2 + (i) % 2 * N)
#define JAXMPM_ZIPPED(i) ((i) % 2 * N + (i) / U * U + Half * (U / 2) + (i) % U / 2)
#define JAXMPM_UNZIPPED(i) ((i) / (N / 2) * N + ((i) / U % (N / 2 / U) * 2 + Half) * U + (i) % U)
#define JAXMPM_REPEATED(i) (Offset + (i) % 4)
#define JAXMPM_SPREAD(i) (Offset + (i) / 4)
#define JAXMPM_FOLLOWING(i) (Offset + (i))
#define JAXMPM_EVERY_OTHER(i) (Offset + (i) / G * (2 * G) + (i) % G)
#define JAXMPM_EVERY_QUAD(i) (Offset + (i)*4)
#define JAXMPM_MIDDLES(i) ((i) / 2 * 4 + (i) % 2 + 1)
#define JAXMPM_QUADS(i) \
  ((i) % 4 == 0 ? N + (Offset + (i)) / 4 : (i) % 4 == 3 ? N + N / 2 + (Offset + (i)) / 4 : (Offset + (i)) / 4 * 2 + (i) % 4 - 1)
/// {a[h], b[h], a[h+1], b[h+1], …} with h = 0 (Half 0) or N/2 (Half 1).
template <int Half, class T, int N>
JAXMPM_INLINE Pack<T, N> interleave(Pack<T, N> a, Pack<T, N> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_INTERLEAVED)
}
/// In each unit of U lanes that half of two packs, interleaved.
template <int Half, int U, class T, int N>
JAXMPM_INLINE Pack<T, N> zip(Pack<T, N> a, Pack<T, N> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_ZIPPED)
}
/// The units of U lanes of two packs that are even (Half 0) or odd.
template <int Half, int U, class T, int N>
JAXMPM_INLINE Pack<T, N> unzip(Pack<T, N> a, Pack<T, N> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_UNZIPPED)
}
/// Four lanes from Offset on, again and again; each lane from Offset on four times.
template <int Offset, class T, int N>
JAXMPM_INLINE Pack<T, N> repeat(Pack<T, N> a) {
  JAXMPM_SHUFFLE(a, a, JAXMPM_REPEATED)
}
template <int Offset, class T, int N>
JAXMPM_INLINE Pack<T, N> spread(Pack<T, N> a) {
  JAXMPM_SHUFFLE(a, a, JAXMPM_SPREAD)
}
/// Every other group of G lanes of two packs, from the one at Offset on.
template <int G, int Offset, class T, int N>
JAXMPM_INLINE Pack<T, N> every_other(Pack<T, N> a, Pack<T, N> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_EVERY_OTHER)
}
/// Of each quad of two packs the value at Offset, or the two in the middle.
template <int Offset, int N, class T, int M>
JAXMPM_INLINE Pack<T, N> every_quad(Pack<T, M> a, Pack<T, M> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_EVERY_QUAD)
}
template <class T, int N>
JAXMPM_INLINE Pack<T, N> middles(Pack<T, N> a, Pack<T, N> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_MIDDLES)
}
/// Lanes from Offset on of quads with those middles; `ends`: their firsts, then their lasts.
template <int Offset, class T, int N>
JAXMPM_INLINE Pack<T, N> quads(Pack<T, N> middles, Pack<T, N> ends) {
  JAXMPM_SHUFFLE(middles, ends, JAXMPM_QUADS)
}
/// N lanes of a pack from Offset on; of two packs, as if the second followed the first.
template <int Offset, int N, class T, int M>
JAXMPM_INLINE Pack<T, N> part(Pack<T, M> a, Pack<T, M> b) {
  JAXMPM_SHUFFLE(a, b, JAXMPM_FOLLOWING)
}
#undef JAXMPM_QUADS
#undef JAXMPM_MIDDLES
#undef JAXMPM_EVERY_QUAD
#undef JAXMPM_EVERY_OTHER
#undef JAXMPM_FOLLOWING
#undef JAXMPM_SPREAD
#undef JAXMPM_REPEATED
#undef JAXMPM_UNZIPPED
#undef JAXMPM_ZIPPED
#undef JAXMPM_INTERLEAVED
#undef JAXMPM_SHUFFLE
#undef JAXMPM_LANES_16
#undef JAXMPM_LANES_8
#undef JAXMPM_LANES_4
#undef JAXMPM_LANES_2
}  // namespace pack_detail

template <class T, int N>
JAXMPM_INLINE Pack<T, N / 2> lower_half(Pack<T, N> a) {
  return pack_detail::part<0, N / 2>(a, a);
}
template <class T, int N>
JAXMPM_INLINE Pack<T, N / 2> upper_half(Pack<T, N> a) {
  return pack_detail::part<N / 2, N / 2>(a, a);
}
template <class T, int N>
JAXMPM_INLINE Pack<T, 2 * N> join(Pack<T, N> lower, Pack<T, N> upper) {
  return pack_detail::part<0, 2 * N>(lower, upper);
}

/// The first N lanes of a pack.
template <int N, class T, int M>
JAXMPM_INLINE Pack<T, N> first_lanes(Pack<T, M> a) {
  if constexpr (N == M) return a;
  else return pack_detail::part<0, N>(a, a);
}
/// The lanes of a pack from Offset on, and then those of another.
template <int Offset, class T, int N>
JAXMPM_INLINE Pack<T, N> following_lanes(Pack<T, N> a, Pack<T, N> b) {
  return pack_detail::part<Offset, N>(a, b);
}

/// Each lane as a To: numbers are rounded to floats, and cut off to integers.
template <class To, class T, int N>
JAXMPM_INLINE Pack<To, N> convert(Pack<T, N> a) {
  return Pack<To, N>(__builtin_convertvector(a.v, typename Pack<To, N>::Native));
}

/// Largest lane.
template <class T, int N>
JAXMPM_INLINE T largest(Pack<T, N> a) {
  if constexpr (N == 2) return a[1] > a[0] ? a[1] : a[0];
  else return largest(max(lower_half(a), upper_half(a)));
}
/// Sum of all lanes.
template <class T, int N>
JAXMPM_INLINE T sum_of_lanes(Pack<T, N> a) {
  if constexpr (N == 2) return a[0] + a[1];
  else return sum_of_lanes(lower_half(a) + upper_half(a));
}
/// Whether a comparison holds in any lane.
template <class T, int N>
JAXMPM_INLINE bool any(Mask<T, N> a) {
  if constexpr (N == 2) {
    return (a.m[0] | a.m[1]) != 0;
  } else {
    const Pack<typename Mask<T, N>::Lane, N> lanes(a.m);
    return any(Mask<T, N / 2>{lower_half(lanes).v | upper_half(lanes).v});
  }
}

/// `rounds` perfect shuffles of the lanes of C packs, seen as one deck of cards. With C = 2^rounds packs r[c] = {value c of each of N
/// particles} become the particles' values one after the other; with 2^rounds = N it is the other way round, whatever C (even) is.
template <int rounds, int C, class T, int N>
JAXMPM_INLINE void perfect_shuffles(Pack<T, N>* r) {
  static_assert(C % 2 == 0);
  for (int round = 0; round < rounds; ++round) {
    Pack<T, N> t[C];
    for (int i = 0; i < C / 2; ++i) {
      t[2 * i] = pack_detail::interleave<0>(r[i], r[i + C / 2]);
      t[2 * i + 1] = pack_detail::interleave<1>(r[i], r[i + C / 2]);
    }
    for (int i = 0; i < C; ++i) r[i] = t[i];
  }
}
/// Logarithm to base 2 of a power of two.
constexpr int log2_of(int n) { return n <= 1 ? 0 : 1 + log2_of(n / 2); }

namespace pack_detail {
/// Replaces each two of N packs whose numbers differ by `apart` alone, a and b, by first(a, b) and second(a, b).
template <int apart, class T, int N, class First, class Second>
JAXMPM_INLINE void join_pairs(Pack<T, N>* r, First first, Second second) {
  static_for<N / 2>([&](auto k) JAXMPM_INLINE_LAMBDA {
    constexpr int i = k / apart * 2 * apart + k % apart;
    const Pack<T, N> a = r[i], b = r[i + apart];
    r[i] = first(a, b), r[i + apart] = second(a, b);
  });
}
template <int U, int apart, class T, int N>
JAXMPM_INLINE void zip_pairs(Pack<T, N>* r) {
  using P = Pack<T, N>;
  join_pairs<apart>(
      r, [](P a, P b) { return zip<0, U>(a, b); }, [](P a, P b) { return zip<1, U>(a, b); });
  if constexpr (apart > 1) zip_pairs<U, apart / 2>(r);
}
template <int U, int apart, class T, int N>
JAXMPM_INLINE void unzip_pairs(Pack<T, N>* r) {
  using P = Pack<T, N>;
  join_pairs<apart>(
      r, [](P a, P b) { return unzip<0, U>(a, b); }, [](P a, P b) { return unzip<1, U>(a, b); });
  if constexpr (2 * apart < N) unzip_pairs<U, 2 * apart>(r);
}
}  // namespace pack_detail

/// Transposes N packs of N lanes in place: as perfect shuffles do, but in steps that processors have as instructions of their own. First the
/// lanes of units of 16 bytes change places with as many bits of the pack's number, then the units with the others.
template <class T, int N>
JAXMPM_INLINE void transpose(Pack<T, N>* r) {
  constexpr int unit = 16 / int(sizeof(T)), U = unit < N ? unit : N;
  if constexpr (U > 1) pack_detail::zip_pairs<U, U / 2>(r);
  if constexpr (U < N) pack_detail::unzip_pairs<U, U>(r);
}

/// N values from memory, where they were stored in pieces of `piece` lanes or more: a load never takes from two of them.
template <class T, int N, int piece>
JAXMPM_INLINE Pack<T, N> load_pieces(const T* p) {
  if constexpr (piece >= N) return Pack<T, N>::load(p);
  else return join(load_pieces<T, N / 2, piece>(p), load_pieces<T, N / 2, piece>(p + N / 2));
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

/// Of N/2 quads in memory the two values in the middle, the first, and the last.
template <int N, class T>
JAXMPM_INLINE Pack<T, N> load_middles(const T* at) {
  return pack_detail::middles(Pack<T, N>::load(at), Pack<T, N>::load(at + N));
}
template <int N, class T>
JAXMPM_INLINE Pack<T, N / 2> load_firsts(const T* at) {
  return pack_detail::every_quad<0, N / 2>(Pack<T, N>::load(at), Pack<T, N>::load(at + N));
}
template <int N, class T>
JAXMPM_INLINE Pack<T, N / 2> load_lasts(const T* at) {
  return pack_detail::every_quad<3, N / 2>(Pack<T, N>::load(at), Pack<T, N>::load(at + N));
}
/// Adds to the first of those quads: the middle from the first two lanes of a pack, the first and the last from the first lane of others.
template <class T, int N, int Half>
JAXMPM_INLINE void add_to_first_quad(T* at, Pack<T, N> middles, Pack<T, Half> firsts, Pack<T, Half> lasts) {
  const auto ends = join(first_lanes<2>(firsts), first_lanes<2>(lasts));
  (Pack<T, 4>::load(at) + pack_detail::quads<0>(first_lanes<4>(middles), ends)).store(at);
}
/// Adds to all of those values.
template <class T, int N, int Half>
JAXMPM_INLINE void add_to_quads(T* at, Pack<T, N> middles, Pack<T, Half> firsts, Pack<T, Half> lasts) {
  static_assert(2 * Half == N);
  const Pack<T, N> ends = join(firsts, lasts);
  (Pack<T, N>::load(at) + pack_detail::quads<0>(middles, ends)).store(at);
  (Pack<T, N>::load(at + N) + pack_detail::quads<N>(middles, ends)).store(at + N);
}

}  // namespace jaxmpm
