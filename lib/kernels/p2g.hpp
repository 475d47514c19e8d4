#pragma once
// Particles to grid (Eqs 10–12, B.1, B.2): one tile scatters mass, momentum and impulse of the internal force to its arena.
#include "kernels/material_kernel.hpp"
#include "kernels/stencil.hpp"

namespace jaxmpm {

/// Constants of one step.
template <class T>
struct StepConstants {
  T dt, cell_size, flip_fraction;
  T volume_averaging = T(0);
};

/// Values of one plane at the nodes of a stencil, kept in registers while consecutive particles share a base node: all four of a node, or
/// (V = 2) momenta alone, with masses beside them if they are asked for. Along the axes before the last: rows[a·S + b] in 3D, rows[a] in
/// 2D, each of `pieces` packs.
template <class Sch, bool Masses>
struct StencilRows {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, V = Sch::V, count = Sch::Dim == 3 ? S * S : S;
  static constexpr bool masses_apart = Masses && V == 2;
  using Row = RowShape<T, S, V>;
  static constexpr int quads_per_piece = Row::N / V, step = 4 * quads_per_piece;
  using R = Pack<T, Row::N>;
  using M = Pack<T, V == 2 ? quads_per_piece : Row::N>;
  R row[count][Row::pieces];
  M mass[masses_apart ? count : 1][Row::pieces];

  static constexpr int place(int r) {
    return (Sch::Dim == 3 ? Sch::Shape::arena_node(r / S, r % S, 0) : Sch::Shape::arena_node(r, 0, 0)) * 4;
  }
  JAXMPM_INLINE void clear() {
    for (auto& r : row)
      for (R& piece : r) piece = R(T(0));
    if constexpr (masses_apart)
      for (auto& r : mass)
        for (M& piece : r) piece = M(T(0));
  }
  JAXMPM_INLINE void add_to(T* base) const {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) {
        T* at = base + place(r) + c * step;
        if constexpr (V == 2) add_to_quads(at, row[r][c], masses_apart ? mass[r][c] : M(T(0)));
        else (R::load(at) + row[r][c]).store(at);
      }
  }
  JAXMPM_INLINE void load(const T* base) {
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < Row::pieces; ++c) {
        const T* at = base + place(r) + c * step;
        if constexpr (V == 2) row[r][c] = load_middles<Row::N>(at);
        else row[r][c] = R::load(at);
        if constexpr (masses_apart) mass[r][c] = load_firsts<Row::N>(at);
      }
  }
};

/// Loads the rows of all planes at a base node from an arena, unless `loaded` says that they are those.
template <class Sch, bool Masses>
JAXMPM_INLINE void load_rows(StencilRows<Sch, Masses>* rows, const typename Sch::T* arena, int base, int& loaded) {
  if (base == loaded) return;
  loaded = base;
  for (int plane = 0; plane < Sch::planes; ++plane) rows[plane].load(arena + plane * Sch::arena_plane + base * 4);
}

/// Which groups of V values (quads where V = 4) of a particle's row of coefficients a plane takes: `rest` goes with w alone, moments + k with
/// d on axis k, slopes + k with g on axis k; −1: not at all.
struct PlaneQuads {
  int rest, moments, slopes;
};

/// rows += Σ over kinds of factor × group, for one particle (lane l of the stencils).
template <class Sch, int rest, int moments, int slopes, class Stencil, class Rows>
JAXMPM_INLINE void scatter(Rows& rows, const Stencil& t, int l, const typename Sch::T* coefficients) {
  using T = typename Sch::T;
  using Row = typename Rows::Row;
  constexpr int S = Sch::S, N = Row::N, V = Sch::V, last = Sch::Dim - 1;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    const R w = spread<V, Stencil::w_quad, c, N>(z);
    R line(T(0));  // what goes with w on all axes but the last
    if constexpr (rest >= 0) line = w * repeat<V, rest, N>(coefficients);
    if constexpr (moments >= 0) line += spread<V, Stencil::d_quad, c, N>(z) * repeat<V, moments + last, N>(coefficients);
    if constexpr (slopes >= 0) line += spread<V, Stencil::g_quad, c, N>(z) * repeat<V, slopes + last, N>(coefficients);
    R moment[2], slope[2];  // what goes with d or g on one of the other axes
    static_for<Sch::Dim - 1>([&](auto axis) JAXMPM_INLINE_LAMBDA {
      constexpr int k = axis;
      if constexpr (moments >= 0) moment[k] = w * repeat<V, moments + k, N>(coefficients);
      if constexpr (slopes >= 0) slope[k] = w * repeat<V, slopes + k, N>(coefficients);
    });
    // Sums grow by one product at a time, which is one instruction.
    const auto add_along = [&](R& sum, int k, int a) {
      if constexpr (moments >= 0) sum += R(t.d[k][a][l]) * moment[k];
      if constexpr (slopes >= 0) sum += R(t.g[k][a][l]) * slope[k];
    };
    if constexpr (Sch::Dim == 2) {
      for (int a = 0; a < S; ++a) {
        R& row = rows.row[a][c];
        row += R(t.w[0][a][l]) * line;
        add_along(row, 0, a);
      }
    } else {
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
    }
  });
}

/// The same for masses that are kept apart: + w m.
template <class Sch, class Stencil>
JAXMPM_INLINE void scatter_mass(StencilRows<Sch, true>& rows, const Stencil& t, int l, typename Sch::T m) {
  using T = typename Sch::T;
  using M = typename StencilRows<Sch, true>::M;
  const T* z = t.last.row(l) + 4 * Stencil::w_quad;
  for (int c = 0; c < StencilRows<Sch, true>::Row::pieces; ++c) {
    const M line = M(m) * M::load(z + c * M::lanes);
    for (int a = 0; a < Sch::S; ++a) rows.mass[a][c] += M(t.w[0][a][l]) * line;
  }
}

/// Coefficients of W particles, in groups of V values: {m, m v} at rest, per axis m C Δx for the affine velocity, and −Δt V σ times 1/Δx
/// (slopes) or Δx D⁻¹ (moments) for the force; where θ is kept, m θ in the first quad (2D) or in one of its own (3D).
template <class Sch>
struct Coefficients {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, V = Sch::V, W = batch<T>;
  using P = Pack<T, W>;
  static constexpr bool affine_and_force = Sch::affine && Sch::mls;  // both ride on d: one set of groups
  static constexpr int affine = 1;
  static constexpr int force = Sch::affine && !Sch::mls ? 1 + Dim : 1;
  static constexpr int dilation = !Sch::dilation ? -1 : (Dim == 2 ? 0 : force + Dim);
  static constexpr int groups = force + Dim + int(dilation > 0);
  ParticleRows<T, V * groups> rows;
  alignas(64) T mass[W];  // where masses are kept apart

  /// FLIP keeps the momentum and the impulse of the forces apart.
  static constexpr PlaneQuads in_plane(int plane) {
    constexpr int moments = Sch::mls ? force : (Sch::affine ? affine : -1), slopes = Sch::mls ? -1 : force;
    constexpr int second = Dim == 3 ? dilation : -1;
    if (Sch::flip) return plane == 0 ? PlaneQuads{0, -1, -1} : PlaneQuads{second, moments, slopes};
    return plane == 0 ? PlaneQuads{0, moments, slopes} : PlaneQuads{second, -1, -1};
  }

  JAXMPM_INLINE Coefficients(const Particles<T, Dim>& p, std::size_t s, int count, const MaterialKernel<T, Dim>& material,
                             const StepConstants<T>& step) {
    P q[decltype(rows)::stride];
    for (P& x : q) x = P(T(0));
    const auto component = [&](int group, int c) -> P& { return q[V * group + Sch::vector_at + c]; };
    const P m = load(p.mass.data() + s, count);
    if constexpr (V == 2) m.store(mass);
    else q[0] = m;
    for (int c = 0; c < Dim; ++c) component(0, c) = m * load(p.velocity[std::size_t(c)].data() + s, count);
    if constexpr (Sch::dilation)
      if (!p.dilation.empty()) q[V * dilation + Sch::dilation_lane] = m * load(p.dilation[0].data() + s, count);
    if constexpr (Sch::affine) {
      const P scale = m * P(step.cell_size);
      for (int c = 0; c < Dim; ++c)
        for (int k = 0; k < Dim; ++k) component(affine + k, c) = scale * load(p.affine[std::size_t(c * Dim + k)].data() + s, count);
    }
    alignas(64) T sigma[Symmetric<T, Dim>::size][W];
    material.stress(p, s, count, sigma);
    const P e = load(p.compression.data() + s, count);
    const P impulse =
        m * P(-step.dt * (Sch::gradient_scale / step.cell_size) / material.reference_density()) / (P(T(1)) + e);  // −Δt V / Δx
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) component(force + k, c) += impulse * P::load(sigma[Symmetric<T, Dim>::index(c, k)]);
    rows.fill(q);
  }
};

/// Scatters particles [begin, end) of a body to `arena`, which it clears first. `origin`: node 0 of the arena.
template <class Sch>
void p2g_tile(const Particles<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end,
              const MaterialKernel<typename Sch::T, Sch::Dim>& material, const StepConstants<typename Sch::T>& step,
              const Index<Sch::Dim>& origin, typename Sch::T* arena) {
  using T = typename Sch::T;
  using Q = Coefficients<Sch>;
  std::memset(arena, 0, sizeof(T) * Sch::arena_size);
  StencilRows<Sch, true> rows[Sch::planes];
  for (auto& r : rows) r.clear();
  int current = -1;
  const auto flush = [&] {
    for (int plane = 0; plane < Sch::planes; ++plane) rows[plane].add_to(arena + plane * Sch::arena_plane + current * 4);
  };
  for_each_batch<T>(begin, end, [&](std::size_t s, int count) JAXMPM_INLINE_LAMBDA {
    const Stencils<Sch, Sch::p2g_moments, Sch::p2g_slopes> t(p, s, count, origin);
    const Q q(p, s, count, material, step);
    for (int l = 0; l < count; ++l) {
      if (t.base[l] != current) {
        if (current >= 0) flush();
        for (auto& r : rows) r.clear();
        current = t.base[l];
      }
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneQuads of = Q::in_plane(plane);
        scatter<Sch, of.rest, of.moments, of.slopes>(rows[plane], t, l, q.rows.row(l));
      });
      if constexpr (Sch::V == 2) scatter_mass<Sch>(rows[0], t, l, q.mass[l]);
    }
  });
  if (current >= 0) flush();
}

}  // namespace jaxmpm
