#pragma once
// Stencils in 2D, where lanes are particles throughout: the rows of nodes around W particles are turned into packs of one value of one node
// each, and back. That takes fewer moves across lanes than to lay out a particle's factors by node, as 3D does with its many nodes.
#include "core/tensor.hpp"
#include "kernels/batch.hpp"
#include "kernels/scheme.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Base nodes of W particles in their block's arena and the factors of each axis. `Derived`: with the derivatives of the factors by the
/// particle's place: w' = g, d' = (w (X_i − X_p))' = g (X_i − X_p) − w and g'.
template <class Sch, bool Moments, bool Slopes, bool Derived>
struct Stencils2d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, W = batch<T>;
  using P = Pack<T, W>;
  enum Kind { w, d, g, dd, gg, kinds };
  static constexpr bool with_g = Slopes || Derived, with_dd = Moments && Derived, with_gg = Slopes && Derived;

  alignas(64) int base[W];
  P factor[2][kinds][S];             // [axis][kind][node]
  alignas(64) T first[g + 1][S][W];  // w, d and g of the first axis, to be broadcast

  JAXMPM_INLINE Stencils2d(const Particles<T, 2>& p, std::size_t s, int count, const Index<2>& origin) {
    Pack<int, W> node(0);
    for (int axis = 0; axis < 2; ++axis) {
      const auto X = load_places<W>(p.position[std::size_t(axis)].data() + s, count);
      const auto first = make_places<W>([&](std::size_t k) { return floor(X[k] - Bspline<S>::base_shift); });
      node = node * Pack<int, W>(Sch::Shape::A) + (from_places<int, W>(first) - Pack<int, W>(origin[std::size_t(axis)]));
      const P f = from_places<T, W>(make_places<W>([&](std::size_t k) { return X[k] - first[k]; }));
      P(&of)[kinds][S] = factor[axis];
      Bspline<S>::weights(f, of[w]);
      if constexpr (with_g) Bspline<S>::slopes(f, of[g]);
      if constexpr (with_gg) Bspline<S>::curvatures(f, of[gg]);
      for (int a = 0; a < S; ++a) {
        const P distance = P(T(a)) - f;
        if constexpr (Moments) of[d][a] = of[w][a] * distance;
        if constexpr (with_dd) of[dd][a] = of[g][a] * distance - of[w][a];
      }
    }
    for (int a = 0; a < S; ++a) {
      factor[0][w][a].store(first[w][a]);
      if constexpr (Moments) factor[0][d][a].store(first[d][a]);
      if constexpr (Slopes) factor[0][g][a].store(first[g][a]);
    }
    node.store(base);
  }
};

/// The values of a stencil's nodes, kept in registers while consecutive particles share a base node: rows along the last axis of pairs, the
/// two values in the middle of a quad (momentum, velocity or impulse), and of single values, the first (with Masses) and the last (θ).
template <class Sch, bool Masses>
struct StencilRows2d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, wanted = S == 2 ? 4 : 8;
  static constexpr int N = native_lanes<T> < wanted ? native_lanes<T> : wanted, pieces = (2 * S + N - 1) / N, lanes = N * pieces;
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
  JAXMPM_INLINE void load(const T* arena, int base) {
    for_each(base, [&](int plane, int a, int c, int at) JAXMPM_INLINE_LAMBDA {
      pair[plane][a][c] = load_middles<N>(arena + at);
      if (plane > 0) return;
      if constexpr (masses) mass[a][c] = load_firsts<N>(arena + at);
      if constexpr (thetas) theta[a][c] = load_lasts<N>(arena + at);
    });
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

/// One kind of rows for each of W particles, `C` values in pieces of `piece`: what lies there by particle turned into packs by value, and back.
template <class T, int C, int piece>
struct BatchRows {
  static constexpr int W = batch<T>, values = C;
  alignas(64) T value[W * C];

  JAXMPM_INLINE void put(int lane, int c, Pack<T, piece> x) { x.store(value + lane * C + c * piece); }
  JAXMPM_INLINE Pack<T, piece> get(int lane, int c) const { return Pack<T, piece>::load(value + lane * C + c * piece); }
  JAXMPM_INLINE void read(Pack<T, W>* packs) const {
    for (int k = 0; k < C; ++k) packs[k] = load_pieces<T, W, piece>(value + k * W);
    if constexpr (C == W) transpose(packs);
    else perfect_shuffles<log2_of(W), C>(packs);
  }
  JAXMPM_INLINE void write(Pack<T, W>* packs) {
    if constexpr (C == W) transpose(packs);
    else perfect_shuffles<log2_of(C), C>(packs);
    for (int k = 0; k < C; ++k) packs[k].store(value + k * W);
  }
};

/// StencilRows2d of W particles.
template <class Sch, bool Masses>
struct BatchStencils {
  using Rows = StencilRows2d<Sch, Masses>;
  using T = typename Sch::T;
  static constexpr int S = Sch::S, pieces = Rows::pieces;
  BatchRows<T, Rows::lanes, Rows::N> pair[Sch::planes][S];
  BatchRows<T, Rows::lanes / 2, Rows::N / 2> mass[Rows::masses ? S : 1], theta[Rows::thetas ? S : 1];

  JAXMPM_INLINE void put(int lane, const Rows& from) {
    for (int a = 0; a < S; ++a)
      for (int c = 0; c < pieces; ++c) {
        for (int plane = 0; plane < Sch::planes; ++plane) pair[plane][a].put(lane, c, from.pair[plane][a][c]);
        if constexpr (Rows::masses) mass[a].put(lane, c, from.mass[a][c]);
        if constexpr (Rows::thetas) theta[a].put(lane, c, from.theta[a][c]);
      }
  }
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
  using Pairs = BatchRows<T, Rows::lanes, Rows::N>;
  using Singles = BatchRows<T, Rows::lanes / 2, Rows::N / 2>;

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
  JAXMPM_INLINE void flush() {
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
      flush();
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
      write(with_w[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA {
        P sum(T(0));
        if constexpr (rest >= 0) sum = y[t.w][b] * values[2 * rest + c];
        if constexpr (moments >= 0) sum += y[t.d][b] * values[2 * (moments + 1) + c];
        if constexpr (slopes >= 0) sum += y[t.g][b] * values[2 * (slopes + 1) + c];
        return sum;
      });
      if constexpr (moments >= 0)
        write(with_d[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA { return y[t.w][b] * values[2 * moments + c]; });
      if constexpr (slopes >= 0)
        write(with_g[plane], [&](int b, int c) JAXMPM_INLINE_LAMBDA { return y[t.w][b] * values[2 * slopes + c]; });
    }
    template <class F>
    static JAXMPM_INLINE void write(Pairs& to, F value) {
      P node[Rows::lanes];
      for (int b = 0; b < S; ++b)
        for (int c = 0; c < 2; ++c) node[2 * b + c] = value(b, c);
      for (int k = 2 * S; k < Rows::lanes; ++k) node[k] = P(T(0));
      to.write(node);
    }
    template <class Stencil>
    static JAXMPM_INLINE void set_single(Singles& to, const Stencil& t, const P& value) {
      P node[Rows::lanes / 2];
      for (int b = 0; b < S; ++b) node[b] = t.factor[1][t.w][b] * value;
      for (int k = S; k < Rows::lanes / 2; ++k) node[k] = P(T(0));
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

/// Sums over the nodes of a stencil of factor i along the first axis × factor j along the second × the node's C values: those that a gather
/// asks for (`moments`, `slopes`), and with Derived the derivatives of these by the particle's place.
template <class Stencil, bool moments, bool slopes, bool Derived, int C>
struct FactorSums {
  using P = typename Stencil::P;
  using Values = Vector<P, C>;
  static constexpr int S = Stencil::S, kinds = Stencil::kinds;
  Values at[kinds][kinds];

  static constexpr bool asks_for(int i, int j) {
    using St = Stencil;
    const auto is = [&](int first, int second) { return (i == first && j == second) || (i == second && j == first); };
    const bool value = i == St::w && j == St::w, moment = moments && is(St::d, St::w), slope = slopes && is(St::g, St::w);
    if (value || moment || slope || !Derived) return value || moment || slope;
    return is(St::g, St::w) || (moments && (is(St::dd, St::w) || is(St::g, St::d))) || (slopes && (is(St::gg, St::w) || is(St::g, St::g)));
  }
  static constexpr bool asks_for_second(int j) {
    for (int i = 0; i < kinds; ++i)
      if (asks_for(i, j)) return true;
    return false;
  }

  /// The rows of nodes, as BatchStencils has them.
  template <class From>
  JAXMPM_INLINE void sum(const Stencil& t, const From* rows) {
    static_for<S>([&](auto a) JAXMPM_INLINE_LAMBDA {
      P node[From::values];
      rows[a].read(node);
      static_for<kinds>([&](auto j) JAXMPM_INLINE_LAMBDA {
        if constexpr (asks_for_second(j)) {
          Values line;
          for (int c = 0; c < C; ++c) {
            line[c] = t.factor[1][j][0] * node[c];
            for (int b = 1; b < S; ++b) line[c] += t.factor[1][j][b] * node[C * b + c];
          }
          static_for<kinds>([&](auto i) JAXMPM_INLINE_LAMBDA {
            if constexpr (asks_for(i, j))
              for (int c = 0; c < C; ++c) at[i][j][c] = a == 0 ? t.factor[0][i][a] * line[c] : at[i][j][c] + t.factor[0][i][a] * line[c];
          });
        }
      });
    });
  }
  /// by[j] += the derivative by the place along axis j of what the particles' values and the nodes make together: where a factor of an axis
  /// stands alone it is replaced by its derivative, w by g, d by d', g by g'.
  template <int rest, int first_moment, int first_slope>
  JAXMPM_INLINE void add_by_place(const P* values, P* by) const {
    using St = Stencil;
    for (int c = 0; c < C; ++c) {
      const auto add = [&](int group, const Values& by_x, const Values& by_y) {
        by[0] += values[C * group + c] * by_x[c], by[1] += values[C * group + c] * by_y[c];
      };
      if constexpr (rest >= 0) add(rest, at[St::g][St::w], at[St::w][St::g]);
      if constexpr (moments) add(first_moment, at[St::dd][St::w], at[St::d][St::g]);
      if constexpr (moments) add(first_moment + 1, at[St::g][St::d], at[St::w][St::dd]);
      if constexpr (slopes) add(first_slope, at[St::gg][St::w], at[St::g][St::g]);
      if constexpr (slopes) add(first_slope + 1, at[St::g][St::g], at[St::w][St::gg]);
    }
  }
  /// To the groups of a gather.
  template <int rest, int first_moment, int first_slope>
  JAXMPM_INLINE void store(P* sums) const {
    using St = Stencil;
    for (int c = 0; c < C; ++c) {
      sums[C * rest + c] = at[St::w][St::w][c];
      if constexpr (moments) sums[C * first_moment + c] = at[St::d][St::w][c], sums[C * (first_moment + 1) + c] = at[St::w][St::d][c];
      if constexpr (slopes) sums[C * first_slope + c] = at[St::g][St::w][c], sums[C * (first_slope + 1) + c] = at[St::w][St::g][c];
    }
  }
};

/// What is gathered from the nodes around W particles in all planes.
template <class Sch, class Stencil, class Terms, bool Masses, bool Derived>
struct GatheredSums {
  using P = typename Stencil::P;
  template <int plane>
  using Pairs = FactorSums<Stencil, (Terms::in_plane(plane).moments >= 0), (Terms::in_plane(plane).slopes >= 0), Derived, 2>;
  using Singles = FactorSums<Stencil, false, false, Derived, 1>;
  Pairs<0> first;
  Pairs<Sch::planes - 1> second;
  Singles mass, theta;

  template <int plane>
  JAXMPM_INLINE auto& pairs() {
    if constexpr (plane == 0) return first;
    else return second;
  }
  JAXMPM_INLINE void sum(const Stencil& t, const BatchStencils<Sch, Masses>& nodes) {
    static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA { pairs<plane>().sum(t, nodes.pair[plane]); });
    if constexpr (Masses) mass.sum(t, nodes.mass);
    if constexpr (Sch::dilation) theta.sum(t, nodes.theta);
  }
  JAXMPM_INLINE void store(P* sums) {
    static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
      constexpr PlaneTerms of = Terms::in_plane(plane);
      pairs<plane>().template store<of.rest, of.moments, of.slopes>(sums);
    });
    if constexpr (Masses) mass.template store<Terms::mass, -1, -1>(sums);
    if constexpr (Sch::dilation) theta.template store<Terms::theta, -1, -1>(sums);
  }
  /// by[j] += the derivative by the place along axis j of what the particles' values (as Of has them) and the nodes make together.
  template <class Of>
  JAXMPM_INLINE void add_by_place(const Values2d<typename Sch::T, Of>& values, P* by) {
    static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
      constexpr PlaneTerms of = Of::in_plane(plane);
      pairs<plane>().template add_by_place<of.rest, of.moments, of.slopes>(values.pack, by);
    });
    if constexpr (Masses) mass.template add_by_place<Of::mass, -1, -1>(values.pack, by);
    if constexpr (Sch::dilation) theta.template add_by_place<Of::theta, -1, -1>(values.pack, by);
  }
};

/// Gathers from the nodes of an arena.
template <class Sch, bool Masses>
class Gather2d {
  using T = typename Sch::T;
  static constexpr int W = batch<T>;

 public:
  explicit Gather2d(const T* arena) : arena_(arena) { rows_.clear(); }

  /// Σ over the stencil of factor × node for W particles (those of the stencils t), in the groups of Terms.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int, Pack<T, W>* sums) {
    GatheredSums<Sch, Stencil, Terms, Masses, false> gathered;
    this->sum(t, gathered);
    gathered.store(sums);
  }
  template <class Stencil, class Sums>
  JAXMPM_INLINE void sum(const Stencil& t, Sums& gathered) {
    BatchStencils<Sch, Masses> nodes;
    for (int l = 0; l < W; ++l) {
      if (t.base[l] != loaded_) rows_.load(arena_, loaded_ = t.base[l]);
      nodes.put(l, rows_);
    }
    gathered.sum(t, nodes);
  }

 private:
  const T* arena_;
  StencilRows2d<Sch, Masses> rows_;
  int loaded_ = -1;  // base node of rows_
};

}  // namespace jaxmpm
