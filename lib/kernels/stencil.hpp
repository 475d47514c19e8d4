#pragma once
// Stencils of W particles at once, laid out for the row loops: nodes of a row (along the last axis) are contiguous, four values each.
#include <array>
#include <cmath>
#include <cstring>

#include "core/pack.hpp"
#include "core/scalar.hpp"
#include "kernels/scheme.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Width of the particle loops.
template <class T>
inline constexpr int batch = native_lanes<T>;

/// Lanes of one piece of a row, and pieces per row. A row has S nodes of four values.
template <class T, int S>
struct RowShape {
  static constexpr int wanted = S == 2 ? 8 : 16;
  static constexpr int N = native_lanes<T> < wanted ? native_lanes<T> : wanted;
  static constexpr int pieces = (4 * S + N - 1) / N;
};

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

// Places along an axis and the derivatives by them are in double precision whatever T is: W of them are one or two packs.
template <int W>
inline constexpr int place_lanes = native_lanes<double> < W ? native_lanes<double> : W;

/// As load(): X[0] … X[W − 1].
template <int W>
JAXMPM_INLINE void load_places(const double* p, int count, double (&X)[W]) {
  constexpr int N = place_lanes<W>;
  if (count == W) {
    for (int l = 0; l < W; l += N) Pack<double, N>::load(p + l).store(X + l);
  } else {
    for (int l = 0; l < W; ++l) X[l] = p[l < count ? l : count - 1];
  }
}
/// The lanes of a pack in the precision of places.
template <class T>
struct PlaceChange {
  static constexpr int W = batch<T>;
  alignas(64) double value[W];
  explicit JAXMPM_INLINE PlaceChange(Pack<T, W> change) {
    alignas(64) T lane[W];
    change.store(lane);
    for (int l = 0; l < W; ++l) value[l] = double(lane[l]);
  }
};

/// Bounds of the places along an axis, cells. Past `lower` and `upper`, which are closed faces, nothing stays; no face holds what comes to
/// lie past `lowest` and `highest` (held_within). Infinite where there are none.
struct PlaceBounds {
  double lower, upper, lowest, highest;
};
template <int Dim>
using DomainBounds = std::array<PlaceBounds, std::size_t(Dim)>;

/// p[l] += change[l] for the first `count`, as far as closed faces let them. Returns whether all of them are where faces hold them; those
/// that are not, and what is no number, stay as they are.
template <class T>
JAXMPM_INLINE bool move_places(double* p, int count, Pack<T, batch<T>> change, const PlaceBounds& at) {
  constexpr int W = batch<T>, N = place_lanes<W>;
  using X = Pack<double, N>;
  const PlaceChange<T> by(change);
  if (count < W) {
    bool inside = true;
    for (int l = 0; l < count; ++l) {
      const double x = p[l] + by.value[l];
      const bool held = x >= at.lowest && x <= at.highest;
      p[l] = held ? min(max(x, at.lower), at.upper) : x;
      inside = inside && held;
    }
    return inside;
  }
  Mask<double, N> outside{};
  for (int l = 0; l < W; l += N) {
    const X x = X::load(p + l) + X::load(by.value + l);
    const Mask<double, N> held = (x >= X(at.lowest)) & (x <= X(at.highest));
    select(held, min(max(x, X(at.lower)), X(at.upper)), x).store(p + l);
    outside = outside | !held;
  }
  return !any(outside);
}

/// Adjoint of what the faces do in move_places: derivatives `bar` by the first `count` places that p[l] + change[l] became are none where a
/// face holds them.
template <class T>
JAXMPM_INLINE void drop_held(const double* p, int count, Pack<T, batch<T>> change, const PlaceBounds& at, double* bar) {
  constexpr int W = batch<T>, N = place_lanes<W>;
  using X = Pack<double, N>;
  const PlaceChange<T> by(change);
  if (count < W) {
    for (int l = 0; l < count; ++l) {
      const double x = p[l] + by.value[l];
      if (x < at.lower || x > at.upper) bar[l] = 0;
    }
    return;
  }
  for (int l = 0; l < W; l += N) {
    const X x = X::load(p + l) + X::load(by.value + l);
    select((x < X(at.lower)) | (x > X(at.upper)), X(0.0), X::load(bar + l)).store(bar + l);
  }
}

/// p[l] += change[l] for the first `count` derivatives by places.
template <class T>
JAXMPM_INLINE void add_to_places(double* p, int count, Pack<T, batch<T>> change) {
  constexpr int W = batch<T>, N = place_lanes<W>;
  using X = Pack<double, N>;
  const PlaceChange<T> by(change);
  if (count < W) {
    for (int l = 0; l < count; ++l) p[l] += by.value[l];
    return;
  }
  for (int l = 0; l < W; l += N) (X::load(p + l) + X::load(by.value + l)).store(p + l);
}

/// Sum of the first `count` lanes.
template <class T>
JAXMPM_INLINE double sum_of(Pack<T, batch<T>> value, int count) {
  double sum = 0;
  for (int l = 0; l < count; ++l) sum += double(value[l]);
  return sum;
}

/// Values of W particles, one row of `stride` values a particle: a transposed copy of `Count` packs.
template <class T, int Count>
struct ParticleRows {
  static constexpr int W = batch<T>;
  static constexpr int stride = (Count + W - 1) / W * W;
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

/// Base nodes of W particles in their block's arena and the factors of each axis. `Derived`: with the derivatives of the factors by the
/// particle's place: w' = g, d' = (w (X_i − X_p))' = g (X_i − X_p) − w and g'.
template <class Sch, bool Moments, bool Slopes, bool Derived = false>
struct Stencils {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  static constexpr bool with_g = Slopes || Derived, with_dd = Moments && Derived, with_gg = Slopes && Derived;
  /// Quads of a row along the last axis: w, then d, then g, d' and g'.
  static constexpr int w_quad = 0, d_quad = 1, g_quad = Moments ? 2 : 1, dd_quad = g_quad + int(with_g), gg_quad = dd_quad + int(with_dd);
  static constexpr int quads = gg_quad + int(with_gg);

  alignas(64) int base[W];
  alignas(64) T w[Dim - 1][S][W], d[Dim - 1][S][W], g[Dim - 1][S][W];  // axes but the last, to be broadcast
  alignas(64) T dd[with_dd ? Dim - 1 : 1][S][W], gg[with_gg ? Dim - 1 : 1][S][W];
  ParticleRows<T, 4 * quads> last;  // the last axis, to be spread

  JAXMPM_INLINE Stencils(const Particles<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin) {
    constexpr int A = Sch::Shape::A;
    for (int l = 0; l < W; ++l) base[l] = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      alignas(64) T offset[W];
      alignas(64) double X[W];
      load_places(p.position[std::size_t(axis)].data() + s, count, X);
      const int o = origin[std::size_t(axis)];
      alignas(64) double first[W];  // loops that do one thing become vector instructions
      for (int l = 0; l < W; ++l) first[l] = std::floor(X[l] - Bspline<S>::base_shift);
      for (int l = 0; l < W; ++l) base[l] = base[l] * A + (int(first[l]) - o);
      for (int l = 0; l < W; ++l) offset[l] = T(X[l] - first[l]);
      const P f = P::load(offset);
      P weight[S], slope[S], curvature[S];
      Bspline<S>::weights(f, weight);
      if constexpr (with_g) Bspline<S>::slopes(f, slope);
      if constexpr (with_gg) Bspline<S>::curvatures(f, curvature);
      if (axis < Dim - 1) {
        for (int a = 0; a < S; ++a) {
          weight[a].store(w[axis][a]);
          if constexpr (Moments) (weight[a] * (P(T(a)) - f)).store(d[axis][a]);
          if constexpr (with_g) slope[a].store(g[axis][a]);
          if constexpr (with_dd) (slope[a] * (P(T(a)) - f) - weight[a]).store(dd[axis][a]);
          if constexpr (with_gg) curvature[a].store(gg[axis][a]);
        }
      } else {
        P row[decltype(last)::stride];
        for (P& r : row) r = P(T(0));
        for (int a = 0; a < S; ++a) {
          row[4 * w_quad + a] = weight[a];
          if constexpr (Moments) row[4 * d_quad + a] = weight[a] * (P(T(a)) - f);
          if constexpr (with_g) row[4 * g_quad + a] = slope[a];
          if constexpr (with_dd) row[4 * dd_quad + a] = slope[a] * (P(T(a)) - f) - weight[a];
          if constexpr (with_gg) row[4 * gg_quad + a] = curvature[a];
        }
        last.fill(row);
      }
    }
  }
};

}  // namespace jaxmpm
