#pragma once
// What particles give to the nodes around them, in 3D (stencil_3d.hpp).
#include "kernels/stencil_3d.hpp"

namespace jaxmpm {

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

/// Groups of values of W particles, laid out by particle.
template <class T, class Terms>
struct Values3d {
  ParticleRows<T, Terms::size> rows;
  /// There are as many packs as whole batches have lanes: round_up(Terms::size, batch<T>). They are used up.
  JAXMPM_INLINE explicit Values3d(Pack<T, batch<T>>* values) { rows.fill(values); }
};

/// Adds what particles give to the nodes of an arena.
template <class Sch>
class Scatter3d {
  using T = typename Sch::T;

 public:
  explicit Scatter3d(T* arena) : arena_(arena) {
    std::memset(arena, 0, sizeof(T) * Sch::arena_size);
    rows_.clear(-1);
  }

  /// `count` particles, those of the stencils t.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void add(const Stencil& t, int count, const Values3d<T, Terms>& values) {
    Rows now = rows_;  // in registers, where they fit
    for (int l = 0; l < count; ++l) {
      if (t.base[l] != now.base) {
        now.add_to(arena_);
        now.clear(t.base[l]);
      }
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane);
        scatter_3d<Sch, of.rest, of.moments, of.slopes>(now.plane[plane], t, l, values.rows.row(l));
      });
    }
    rows_ = now;
  }
  /// Once all particles have been added.
  JAXMPM_INLINE void finish() { rows_.add_to(arena_); }

 private:
  /// Sums at the nodes around one base node, still to be added to the arena.
  struct Rows {
    StencilRows3d<Sch> plane[Sch::planes];
    int base;  // −1: of none
    JAXMPM_INLINE void clear(int next) {
      for (auto& rows : plane) rows.clear();
      base = next;
    }
    JAXMPM_INLINE void add_to(T* arena) const {
      for (int k = 0; base >= 0 && k < Sch::planes; ++k) plane[k].add_to(arena + k * Sch::arena_plane + base * 4);
    }
  };
  T* arena_;
  Rows rows_;
};

}  // namespace jaxmpm
