#pragma once
// Stencils in 3D, where lanes are the nodes of a row (along the last axis), four values each: the nodes are summed over the other axes with
// factors of one particle in all lanes, and only those along the last axis are laid out by node.
#include "kernels/batch.hpp"
#include "kernels/scheme.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Base nodes of W particles in their block's arena and the factors of each axis. `Derived`: with the derivatives of the factors by the
/// particle's place: w' = g, d' = (w (X_i − X_p))' = g (X_i − X_p) − w and g'.
template <class Sch, bool Moments, bool Slopes, bool Derived>
struct Stencils3d {
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

  JAXMPM_INLINE Stencils3d(const Particles<T, Dim>& p, std::size_t s, int count, const Index<Dim>& origin) {
    constexpr int A = Sch::Shape::A;
    Pack<int, W> node(0);
    for (int axis = 0; axis < Dim; ++axis) {
      const auto X = load_places<W>(p.position[std::size_t(axis)].data() + s, count);
      const auto first = make_places<W>([&](std::size_t k) { return floor(X[k] - Bspline<S>::base_shift); });
      node = node * Pack<int, W>(A) + (from_places<int, W>(first) - Pack<int, W>(origin[std::size_t(axis)]));
      const P f = from_places<T, W>(make_places<W>([&](std::size_t k) { return X[k] - first[k]; }));
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
    node.store(base);
  }
};

/// Lanes of one piece of a row of S quads, and pieces per row.
template <class T, int S>
struct QuadRow {
  static constexpr int wanted = S == 2 ? 8 : 16;
  static constexpr int N = native_lanes<T> < wanted ? native_lanes<T> : wanted;
  static constexpr int pieces = (4 * S + N - 1) / N;
};

/// Values of one plane at the nodes of a stencil, kept in registers while consecutive particles share a base node: rows[a·S + b], each of
/// `pieces` packs.
template <class Sch>
struct StencilRows3d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, count = S * S;
  using Row = QuadRow<T, S>;
  using R = Pack<T, Row::N>;
  R row[count][Row::pieces];

  static constexpr int place(int r) { return Sch::Shape::arena_node(r / S, r % S, 0) * 4; }
  JAXMPM_INLINE void clear() {
    for (auto& r : row)
      for (R& piece : r) piece = R(T(0));
  }
  JAXMPM_INLINE void add_to(T* base) const {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) {
        T* at = base + place(r) + c * Row::N;
        (R::load(at) + row[r][c]).store(at);
      }
  }
  JAXMPM_INLINE void load(const T* base) {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) row[r][c] = R::load(base + place(r) + c * Row::N);
  }
};

/// rows += Σ over kinds of factor × group, for one particle (lane l of the stencils).
template <class Sch, int rest, int moments, int slopes, class Stencil>
JAXMPM_INLINE void scatter_3d(StencilRows3d<Sch>& rows, const Stencil& t, int l, const typename Sch::T* coefficients) {
  using T = typename Sch::T;
  using Row = QuadRow<T, Sch::S>;
  constexpr int S = Sch::S, N = Row::N, last = 2;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    const R w = spread_quad<Stencil::w_quad, c, N>(z);
    R line(T(0));  // what goes with w on all axes but the last
    if constexpr (rest >= 0) line = w * repeat_quad<rest, N>(coefficients);
    if constexpr (moments >= 0) line += spread_quad<Stencil::d_quad, c, N>(z) * repeat_quad<moments + last, N>(coefficients);
    if constexpr (slopes >= 0) line += spread_quad<Stencil::g_quad, c, N>(z) * repeat_quad<slopes + last, N>(coefficients);
    R moment[2], slope[2];  // what goes with d or g on one of the other axes
    static_for<2>([&](auto axis) JAXMPM_INLINE_LAMBDA {
      constexpr int k = axis;
      if constexpr (moments >= 0) moment[k] = w * repeat_quad<moments + k, N>(coefficients);
      if constexpr (slopes >= 0) slope[k] = w * repeat_quad<slopes + k, N>(coefficients);
    });
    // Sums grow by one product at a time, which is one instruction.
    const auto add_along = [&](R& sum, int k, int a) {
      if constexpr (moments >= 0) sum += R(t.d[k][a][l]) * moment[k];
      if constexpr (slopes >= 0) sum += R(t.g[k][a][l]) * slope[k];
    };
    R y[S];
    for (int b = 0; b < S; ++b) y[b] = R(T(0)), add_along(y[b], 1, b);
    for (int a = 0; a < S; ++a) {
      const R wx(t.w[0][a][l]);
      R plane = wx * line;
      add_along(plane, 0, a);
      for (int b = 0; b < S; ++b) {
        R& row = rows.row[a * S + b][c];
        row += R(t.w[1][b][l]) * plane;
        row += wx * y[b];
      }
    }
  });
}

/// The end of a gather: part c of the rows along the last axis (factors z), whose nodes have been summed over the other axes with w (`sum`)
/// and with d or g on each of them in turn. Adds to the sums of the parts before; the first one sets them.
template <class Sch, int c, bool moments, bool slopes, class Stencil, class R>
JAXMPM_INLINE void gather_last_axis(const typename Sch::T* z, const R& sum, const R* d, const R* g, R* sums) {
  constexpr int N = R::lanes, last = 2, first_moment = 1, first_slope = moments ? 4 : 1;
  const auto put = [&](int group, R value) { sums[group] = c == 0 ? value : sums[group] + value; };
  const R w = spread_quad<Stencil::w_quad, c, N>(z);
  put(0, sum * w);
  if constexpr (moments) {
    for (int k = 0; k < last; ++k) put(first_moment + k, d[k] * w);
    put(first_moment + last, sum * spread_quad<Stencil::d_quad, c, N>(z));
  }
  if constexpr (slopes) {
    for (int k = 0; k < last; ++k) put(first_slope + k, g[k] * w);
    put(first_slope + last, sum * spread_quad<Stencil::g_quad, c, N>(z));
  }
}

/// Σ over the stencil of factor × node, for one particle: groups of sums (the value, then Dim with moments, then Dim with slopes), one pack
/// per (group, lane of the row); still to be added along the row.
template <class Sch, bool moments, bool slopes, class Stencil>
JAXMPM_INLINE void gather_3d(const StencilRows3d<Sch>& rows, const Stencil& t, int l, typename StencilRows3d<Sch>::R* sums) {
  using T = typename Sch::T;
  using Row = QuadRow<T, Sch::S>;
  constexpr int S = Sch::S, N = Row::N;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    R sum(T(0)), d[2] = {R(T(0)), R(T(0))}, g[2] = {R(T(0)), R(T(0))};  // Σ w, and with d or g on one axis but the last
    for (int a = 0; a < S; ++a) {
      R line(T(0)), dy(T(0)), gy(T(0));
      for (int b = 0; b < S; ++b) {
        const R& x = rows.row[a * S + b][c];
        line += R(t.w[1][b][l]) * x;
        if constexpr (moments) dy += R(t.d[1][b][l]) * x;
        if constexpr (slopes) gy += R(t.g[1][b][l]) * x;
      }
      const R wx(t.w[0][a][l]);
      if constexpr (moments) d[1] += wx * dy;
      if constexpr (slopes) g[1] += wx * gy;
      sum += R(t.w[0][a][l]) * line;
      if constexpr (moments) d[0] += R(t.d[0][a][l]) * line;
      if constexpr (slopes) g[0] += R(t.g[0][a][l]) * line;
    }
    gather_last_axis<Sch, c, moments, slopes, Stencil>(z, sum, d, g, sums);
  });
}

/// Groups of values of W particles, laid out by particle.
template <class T, class Terms>
struct Values3d {
  ParticleRows<T, Terms::size> rows;
  /// The packs are padded to whole ones of them (Terms::padded), and used up.
  JAXMPM_INLINE explicit Values3d(Pack<T, batch<T>>* values) { rows.fill(values); }
};

/// Adds what particles give to the nodes of an arena.
template <class Sch>
class Scatter3d {
  using T = typename Sch::T;

 public:
  explicit Scatter3d(T* arena) : arena_(arena) {
    std::memset(arena, 0, sizeof(T) * Sch::arena_size);
    clear();
  }

  /// `count` particles, those of the stencils t.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void add(const Stencil& t, int count, const Values3d<T, Terms>& values) {
    for (int l = 0; l < count; ++l) {
      if (t.base[l] != current_) {
        flush();
        clear();
        current_ = t.base[l];
      }
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane);
        scatter_3d<Sch, of.rest, of.moments, of.slopes>(rows_[plane], t, l, values.rows.row(l));
      });
    }
  }
  /// Once all particles have been added.
  JAXMPM_INLINE void flush() {
    for (int plane = 0; current_ >= 0 && plane < Sch::planes; ++plane)
      rows_[plane].add_to(arena_ + plane * Sch::arena_plane + current_ * 4);
  }

 private:
  T* arena_;
  StencilRows3d<Sch> rows_[Sch::planes];
  int current_ = -1;  // base node of rows_

  JAXMPM_INLINE void clear() {
    for (auto& r : rows_) r.clear();
  }
};

/// The stencils of an arena's nodes, a particle after the other.
template <class Sch>
class NodeRows3d {
  using T = typename Sch::T;

 public:
  explicit NodeRows3d(const T* arena) : arena_(arena) {
    for (auto& r : rows_) r.clear();
  }
  /// The rows of all planes at a base node.
  JAXMPM_INLINE const StencilRows3d<Sch>* at(int base) {
    for (int plane = 0; base != loaded_ && plane < Sch::planes; ++plane) rows_[plane].load(arena_ + plane * Sch::arena_plane + base * 4);
    loaded_ = base;
    return rows_;
  }

 private:
  const T* arena_;
  StencilRows3d<Sch> rows_[Sch::planes];
  int loaded_ = -1;
};

/// Gathers from the nodes of an arena.
template <class Sch>
class Gather3d {
  using T = typename Sch::T;
  using R = typename StencilRows3d<Sch>::R;

 public:
  explicit Gather3d(const T* arena) : nodes_(arena) {}

  /// Σ over the stencil of factor × node for `count` particles (those of the stencils t), in the groups of Terms; lanes behind them repeat
  /// the last.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int count, Pack<T, batch<T>>* sums) {
    constexpr int per_store = R::lanes / 4, padded = (Terms::size / 4 + per_store - 1) / per_store * per_store;
    ParticleRows<T, 4 * padded> gathered;
    for (int l = 0; l < count; ++l) {
      const StencilRows3d<Sch>* rows = nodes_.at(t.base[l]);
      R parts[padded];
      for (int i = Terms::size / 4; i < padded; ++i) parts[i] = R(T(0));
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane);
        gather_3d<Sch, (of.moments >= 0), (of.slopes >= 0)>(rows[plane], t, l, parts + of.rest);
      });
      for (int i = 0; i < padded; i += per_store) sum_quads(parts + i).store(gathered.row(l) + 4 * i);
    }
    for (int l = count; l < batch<T>; ++l) std::memcpy(gathered.row(l), gathered.row(count - 1), sizeof(T) * std::size_t(4 * padded));
    gathered.read(sums);
  }

 private:
  NodeRows3d<Sch> nodes_;
};

}  // namespace jaxmpm
