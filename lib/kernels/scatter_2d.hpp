#pragma once
// What particles give to the nodes around them, in 2D (stencil_2d.hpp).
#include <cstring>

#include "kernels/stencil_2d.hpp"

namespace jaxmpm {

/// What is added to a stencil's nodes, kept in registers while consecutive particles share a base node: rows of pairs, the two values in the
/// middle of a quad (momentum, velocity or impulse), and of single values, the first (with Masses) and the last (θ).
template <class Sch, bool Masses>
struct StencilRows2d {
  using T = typename Sch::T;
  using Row = NodeRow<T, Sch::S, 2>;
  static constexpr int S = Sch::S, N = Row::N, pieces = Row::pieces;
  static constexpr bool masses = Masses, thetas = Sch::dilation;
  using Pair = Pack<T, N>;
  using Single = Pack<T, N / 2>;
  Pair pair[Sch::planes][S][pieces];
  Single mass[masses ? S : 1][pieces], theta[thetas ? S : 1][pieces];

  /// Calls f(plane, a, piece, place in the arena) for all packs of pairs.
  template <class F>
  static JAXMPM_INLINE void for_each(int base, F f) {
    for (int plane = 0; plane < Sch::planes; ++plane)
      for (int a = 0; a < S; ++a)
        for (int c = 0; c < pieces; ++c)
          f(plane, a, c, plane * Sch::arena_plane + 4 * (base + Sch::Shape::arena_node(a, 0, 0)) + c * 2 * N);
  }
  JAXMPM_INLINE void clear() {
    for (auto& plane : pair)
      for (auto& row : plane)
        for (Pair& x : row) x = Pair(T(0));
    for (auto& row : mass)
      for (Single& x : row) x = Single(T(0));
    for (auto& row : theta)
      for (Single& x : row) x = Single(T(0));
  }
  JAXMPM_INLINE void add_to(T* arena, int base) const {
    for_each(base, [&](int plane, int a, int c, int at)
                       JAXMPM_INLINE_LAMBDA { add_to_quads(arena + at, pair[plane][a][c], mass_of(plane, a, c), theta_of(plane, a, c)); });
  }
  /// Adds the first node of each row to the arena, and makes the second the first: for the next base node along the last axis. What the next
  /// particles add to has then not been stored a moment before.
  JAXMPM_INLINE void advance(T* arena, int base) {
    for_each(base, [&](int plane, int a, int c, int at) JAXMPM_INLINE_LAMBDA {
      if (c == 0) add_to_first_quad(arena + at, pair[plane][a][0], mass_of(plane, a, 0), theta_of(plane, a, 0));
      const bool last = c + 1 == pieces;
      pair[plane][a][c] = following_lanes<2>(pair[plane][a][c], last ? Pair(T(0)) : pair[plane][a][c + 1]);
      if (plane > 0) return;
      if constexpr (masses) mass[a][c] = following_lanes<1>(mass[a][c], last ? Single(T(0)) : mass[a][c + 1]);
      if constexpr (thetas) theta[a][c] = following_lanes<1>(theta[a][c], last ? Single(T(0)) : theta[a][c + 1]);
    });
  }

 private:
  JAXMPM_INLINE Single mass_of(int plane, int a, int c) const {
    if constexpr (masses) return plane == 0 ? mass[a][c] : Single(T(0));
    else return Single(T(0));
  }
  JAXMPM_INLINE Single theta_of(int plane, int a, int c) const {
    if constexpr (thetas) return plane == 0 ? theta[a][c] : Single(T(0));
    else return Single(T(0));
  }
};

/// Rows of C values of each of W particles, made of packs by value.
template <class T, int C, int piece>
struct ParticleLines {
  static constexpr int W = batch<T>, values = C;
  alignas(64) T value[W * C];

  JAXMPM_INLINE void write(Pack<T, W>* packs) {
    columns_to_rows<C>(packs);
    for (int k = 0; k < C; ++k) packs[k].store(value + k * W);
  }
  JAXMPM_INLINE Pack<T, piece> get(int l, int c) const { return Pack<T, piece>::load(value + l * C + c * piece); }
};

/// Values of W particles: as they are.
template <class T, class Terms>
struct Values2d {
  const Pack<T, batch<T>>* pack;
  JAXMPM_INLINE explicit Values2d(const Pack<T, batch<T>>* values) : pack(values) {}
};

/// Adds what particles give to the nodes of an arena: lines along the second axis, which each node of the first axis takes with its factor.
template <class Sch, bool Masses>
class Scatter2d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  using Rows = StencilRows2d<Sch, Masses>;
  using Row = typename Rows::Row;
  using Pairs = ParticleLines<T, Row::lanes, Row::N>;
  using Singles = ParticleLines<T, Row::lanes / 2, Row::N / 2>;

 public:
  explicit Scatter2d(T* arena) : arena_(arena) {
    std::memset(arena, 0, sizeof(T) * Sch::arena_size);
    rows_.clear();
  }

  /// `count` particles, those of the stencils t.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void add(const Stencil& t, int count, const Values2d<T, Terms>& values) {
    Lines lines;
    static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
      constexpr PlaneTerms of = Terms::in_plane(plane);
      lines.template set<of.rest, of.moments, of.slopes>(plane, t, values.pack);
    });
    if constexpr (Rows::masses) lines.set_single(lines.mass, t, values.pack[Terms::mass]);
    if constexpr (Rows::thetas) lines.set_single(lines.theta, t, values.pack[Terms::theta]);
    for (int l = 0; l < count; ++l) {
      move_to(t.base[l]);
      for (int c = 0; c < Rows::pieces; ++c) {
        static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
          constexpr PlaneTerms of = Terms::in_plane(plane);
          lines.template add_to<(of.moments >= 0), (of.slopes >= 0)>(rows_.pair[plane], plane, t, l, c);
        });
        if constexpr (Rows::masses) lines.add_single(rows_.mass, lines.mass, t, l, c);
        if constexpr (Rows::thetas) lines.add_single(rows_.theta, lines.theta, t, l, c);
      }
    }
  }
  /// Once all particles have been added.
  JAXMPM_INLINE void finish() {
    if (current_ >= 0) rows_.add_to(arena_, current_);
  }

 private:
  T* arena_;
  Rows rows_;
  int current_ = -1;  // base node of rows_

  JAXMPM_INLINE void move_to(int base) {
    if (base == current_) return;
    if (base == current_ + 1 && current_ >= 0) {
      rows_.advance(arena_, current_);
    } else {
      finish();
      rows_.clear();
    }
    current_ = base;
  }

  /// What W particles give to a node of the first axis with its w, d and g.
  struct Lines {
    Pairs with_w[Sch::planes], with_d[Sch::planes], with_g[Sch::planes];
    Singles mass, theta;

    template <int rest, int moments, int slopes, class Stencil>
    JAXMPM_INLINE void set(int plane, const Stencil& t, const P* values) {
      const P(&y)[Stencil::kinds][S] = t.factor[1];
      write<2>(with_w[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA {
        P sum(T(0));
        if constexpr (rest >= 0) sum = y[t.w][b] * values[2 * rest + c];
        if constexpr (moments >= 0) sum += y[t.d][b] * values[2 * (moments + 1) + c];
        if constexpr (slopes >= 0) sum += y[t.g][b] * values[2 * (slopes + 1) + c];
        return sum;
      });
      if constexpr (moments >= 0)
        write<2>(with_d[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA { return y[t.w][b] * values[2 * moments + c]; });
      if constexpr (slopes >= 0)
        write<2>(with_g[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA { return y[t.w][b] * values[2 * slopes + c]; });
    }
    template <class Stencil>
    static JAXMPM_INLINE void set_single(Singles& to, const Stencil& t, const P& value) {
      write<1>(to, [&](int b, int) JAXMPM_INLINE_LAMBDA { return t.factor[1][t.w][b] * value; });
    }
    /// value(b, c): value c of C at node b of the second axis.
    template <int C, class Into, class F>
    static JAXMPM_INLINE void write(Into& to, F value) {
      P node[Into::values];
      for (int b = 0; b < S; ++b)
        for (int c = 0; c < C; ++c) node[C * b + c] = value(b, c);
      for (int k = C * S; k < Into::values; ++k) node[k] = P(T(0));
      to.write(node);
    }
    /// Piece c of the lines of particle l.
    template <bool moments, bool slopes, class Stencil>
    JAXMPM_INLINE void add_to(typename Rows::Pair (*rows)[Rows::pieces], int plane, const Stencil& t, int l, int c) const {
      using R = typename Rows::Pair;
      const R w = with_w[plane].get(l, c);
      R d, g;
      if constexpr (moments) d = with_d[plane].get(l, c);
      if constexpr (slopes) g = with_g[plane].get(l, c);
      for (int a = 0; a < S; ++a) {  // a particle's share first: the sums of particle after particle wait for each other
        R share = R(t.first[t.w][a][l]) * w;
        if constexpr (moments) share += R(t.first[t.d][a][l]) * d;
        if constexpr (slopes) share += R(t.first[t.g][a][l]) * g;
        rows[a][c] += share;
      }
    }
    template <class Stencil>
    static JAXMPM_INLINE void add_single(typename Rows::Single (*rows)[Rows::pieces], const Singles& from, const Stencil& t, int l, int c) {
      using R = typename Rows::Single;
      const R w = from.get(l, c);
      for (int a = 0; a < S; ++a) rows[a][c] += R(t.first[t.w][a][l]) * w;
    }
  };
};

}  // namespace jaxmpm
