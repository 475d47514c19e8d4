#pragma once
// Loops over particles by batches of W, one a lane: loads, stores, places.
#include <array>
#include <cstring>
#include <tuple>
#include <type_traits>

#include "core/pack_rows.hpp"
#include "core/round_up.hpp"
#include "core/scalar.hpp"

namespace jaxmpm {

/// Width of the particle loops.
template <class T>
inline constexpr int batch = native_lanes<T>;

/// Calls f(s, count) for the batches of particles [begin, end). The number of full ones is a constant, so that what is written for any count
/// costs them nothing once inlined.
template <class T, class F>
JAXMPM_INLINE void for_each_batch(std::size_t begin, std::size_t end, F f) {
  constexpr int W = batch<T>;
  std::size_t s = begin;
  for (; s + W <= end; s += W) f(s, std::integral_constant<int, W>{});
  if (s < end) f(s, int(end - s));
}

/// `count` values from p, the last one repeated to fill the pack; never reads past p[count − 1].
template <class T>
JAXMPM_INLINE Pack<T, batch<T>> load(const T* p, int count) {
  constexpr int W = batch<T>;
  if (count == W) return Pack<T, W>::load(p);
  alignas(64) T lane[W];
  for (int l = 0; l < W; ++l) lane[l] = p[l < count ? l : count - 1];
  return Pack<T, W>::load(lane);
}
template <class T>
JAXMPM_INLINE void store(T* p, Pack<T, batch<T>> value, int count) {
  constexpr int W = batch<T>;
  if (count == W) return value.store(p);
  alignas(64) T lane[W];
  value.store(lane);
  for (int l = 0; l < count; ++l) p[l] = lane[l];
}

/// The first `count` of a batch as they are, zero in the lanes behind.
template <class T>
JAXMPM_INLINE Pack<T, batch<T>> load_zeros_behind(const T* p, int count) {
  constexpr int W = batch<T>;
  if (count == W) return Pack<T, W>::load(p);
  alignas(64) T lane[W] = {};
  for (int l = 0; l < count; ++l) lane[l] = p[l];
  return Pack<T, W>::load(lane);
}

/// Places of W particles along an axis, or the derivatives by them: in double precision whatever T is, so one pack or two.
template <int W>
inline constexpr int place_lanes = native_lanes<double> < W ? native_lanes<double> : W;
template <int W>
using Places = std::array<Pack<double, place_lanes<W>>, std::size_t(W / place_lanes<W>)>;

/// As load().
template <int W>
JAXMPM_INLINE Places<W> load_places(const double* p, int count) {
  constexpr int N = place_lanes<W>;
  alignas(64) double lane[W];
  if (count < W) {
    for (int l = 0; l < W; ++l) lane[l] = p[l < count ? l : count - 1];
    p = lane;
  }
  Places<W> x;
  for (int k = 0; k < W / N; ++k) x[std::size_t(k)] = Pack<double, N>::load(p + k * N);
  return x;
}
template <int W>
JAXMPM_INLINE void store_places(double* p, const Places<W>& x, int count) {
  constexpr int N = place_lanes<W>;
  alignas(64) double lane[W];
  double* to = count < W ? lane : p;
  for (int k = 0; k < W / N; ++k) x[std::size_t(k)].store(to + k * N);
  for (int l = 0; count < W && l < count; ++l) p[l] = lane[l];
}
/// Calls f(k) for the packs of places.
template <int W, class F>
JAXMPM_INLINE Places<W> make_places(F f) {
  if constexpr (std::tuple_size_v<Places<W>> == 1) return {f(0)};
  else return {f(0), f(1)};
}
/// Places as one pack of T, and the other way round.
template <class T, int W>
JAXMPM_INLINE Pack<T, W> from_places(const Places<W>& x) {
  if constexpr (std::tuple_size_v<Places<W>> == 1) return convert<T>(x[0]);
  else return join(convert<T>(x[0]), convert<T>(x[1]));
}
template <class T, int W>
JAXMPM_INLINE Places<W> to_places(Pack<T, W> x) {
  if constexpr (std::tuple_size_v<Places<W>> == 1) return {convert<double>(x)};
  else return {convert<double>(lower_half(x)), convert<double>(upper_half(x))};
}
/// p[l] + change[l].
template <class T>
JAXMPM_INLINE Places<batch<T>> moved(const double* p, int count, Pack<T, batch<T>> change) {
  const auto from = load_places<batch<T>>(p, count), by = to_places(change);
  return make_places<batch<T>>([&](std::size_t k) { return from[k] + by[k]; });
}

/// p[l] += change[l] for the first `count`.
template <class T>
JAXMPM_INLINE void add_to_places(double* p, int count, Pack<T, batch<T>> change) {
  store_places<batch<T>>(p, moved<T>(p, count, change), count);
}

/// Bounds of the places along an axis, cells. Past `lower` and `upper`, which are closed faces, nothing stays; no face holds what comes to
/// lie past `lowest` and `highest` (held_within). Infinite where there are none.
struct PlaceBounds {
  double lower, upper, lowest, highest;
};
template <int Dim>
using DomainBounds = std::array<PlaceBounds, std::size_t(Dim)>;

/// add_to_places() as far as closed faces let it; `change` repeats the last behind `count`. Returns whether all places are where faces hold
/// them; those that are not, and what is no number, stay as they are.
template <class T>
JAXMPM_INLINE bool move_places(double* p, int count, Pack<T, batch<T>> change, const PlaceBounds& at) {
  using X = typename Places<batch<T>>::value_type;
  const auto free = moved<T>(p, count, change);
  Mask<double, X::lanes> inside = X(0.0) == X(0.0);
  const auto held = make_places<batch<T>>([&](std::size_t k) {
    const auto here = (free[k] >= X(at.lowest)) & (free[k] <= X(at.highest));
    inside = inside & here;
    return select(here, min(max(free[k], X(at.lower)), X(at.upper)), free[k]);
  });
  store_places<batch<T>>(p, held, count);
  return !any(!inside);
}

/// Adjoint of what the faces do in move_places(): derivatives `bar` by the places that p[l] + change[l] became are none where a face holds
/// them. Returns what is left.
template <class T>
JAXMPM_INLINE Pack<T, batch<T>> drop_held(const double* p, int count, Pack<T, batch<T>> change, const PlaceBounds& at, double* bar) {
  using X = typename Places<batch<T>>::value_type;
  const auto free = moved<T>(p, count, change), by = load_places<batch<T>>(bar, count);
  const auto left =
      make_places<batch<T>>([&](std::size_t k) { return select((free[k] < X(at.lower)) | (free[k] > X(at.upper)), X(0.0), by[k]); });
  store_places<batch<T>>(bar, left, count);
  return from_places<T, batch<T>>(left);
}

/// Sum of the first `count` lanes, in double precision.
template <class T>
JAXMPM_INLINE double sum_of(Pack<T, batch<T>> value, int count) {
  constexpr int W = batch<T>;
  if (count < W) {
    double sum = 0;
    for (int l = 0; l < count; ++l) sum += double(value[l]);
    return sum;
  }
  const auto parts = to_places(value);
  if constexpr (std::tuple_size_v<Places<W>> == 1) return sum_of_lanes(parts[0]);
  else return sum_of_lanes(parts[0] + parts[1]);
}

/// Values of W particles, one row of `stride` values a particle: a transposed copy of `Count` packs.
template <class T, int Count>
struct ParticleRows {
  static constexpr int W = batch<T>;
  static constexpr int stride = round_up(Count, W);
  alignas(64) T value[W * stride];
  const T* row(int lane) const { return value + lane * stride; }
  T* row(int lane) { return value + lane * stride; }
  /// Zeros for the lanes behind the first `count`.
  JAXMPM_INLINE void clear_behind(int count) {
    if (count < W) std::memset(row(count), 0, sizeof(T) * std::size_t((W - count) * stride));
  }
  /// Fills the rows from packs (of which there are `stride`; the ones past Count are padding).
  JAXMPM_INLINE void fill(Pack<T, W>* packs) {
    for (int first = 0; first < stride; first += W) {
      transpose(packs + first);
      for (int l = 0; l < W; ++l) packs[first + l].store(value + l * stride + first);
    }
  }
  /// The other way round.
  JAXMPM_INLINE void read(Pack<T, W>* packs) const {
    for (int first = 0; first < stride; first += W) {
      for (int l = 0; l < W; ++l) packs[first + l] = Pack<T, W>::load(value + l * stride + first);
      transpose(packs + first);
    }
  }
};

}  // namespace jaxmpm
