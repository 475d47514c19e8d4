#pragma once
// Portable SIMD: a pack of N lanes on the compiler's own vector type, so that g++ and nvcc (host side) both take it. Widths 2 to 16.
// Packs behave as scalars (see tensor.hpp); comparisons give a Mask for select(). Rows of values and quads in memory: pack_rows.hpp.
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
/// Lanes from Offset on of quads with those two values in the middle; `ends`: their firsts, then their lasts.
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

}  // namespace jaxmpm
