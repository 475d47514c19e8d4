#pragma once
// What particles give to the nodes of their stencils on a device (Eqs 10–12, B.1, B.2), component by component: as a record in a team's
// memory, and summed in the registers of the thread that takes one component of a cell's particles.
#include "kernels/device/stencil.hpp"

namespace jaxmpm {

/// One component of a particle's gift: `plain` goes with the weight of a node, d[k] and g[k] with the factors d and g of axis k and the
/// weights of the others (kernels/scheme.hpp).
template <class T, int Dim>
struct Share {
  T plain, d[Dim], g[Dim];
};

/// The same along the axes behind `axis`, at node a of `axis`.
template <int axis, bool with_d, bool with_g, class Sch, class T, int Dim>
JAXMPM_INLINE Share<T, Dim> along(const Factors<Sch>& s, int a, const Share<T, Dim>& q) {
  Share<T, Dim> rest;
  rest.plain = s.w[axis][a] * q.plain;
  if constexpr (with_d) rest.plain += s.d[axis][a] * q.d[axis];
  if constexpr (with_g) rest.plain += s.g[axis][a] * q.g[axis];
  for (int k = axis + 1; k < Dim; ++k) {
    if constexpr (with_d) rest.d[k] = s.w[axis][a] * q.d[k];
    if constexpr (with_g) rest.g[k] = s.w[axis][a] * q.g[k];
  }
  return rest;
}

/// Adds a share to the sums of a stencil's nodes from `axis` on.
template <bool with_d, bool with_g, int axis = 0, class Sch, class T, int Dim>
JAXMPM_INLINE void add_share(const Factors<Sch>& s, const Share<T, Dim>& q, T* sums) {
  constexpr int S = Sch::S, inner = StencilNodes<Sch>::count(Dim - 1 - axis);
  JAXMPM_UNROLL
  for (int a = 0; a < S; ++a) {
    if constexpr (axis < Dim - 1) {
      add_share<with_d, with_g, axis + 1>(s, along<axis, with_d, with_g>(s, a, q), sums + a * inner);
    } else {
      sums[a] += s.w[axis][a] * q.plain;
      if constexpr (with_d) sums[a] += s.d[axis][a] * q.d[axis];
      if constexpr (with_g) sums[a] += s.g[axis][a] * q.g[axis];
    }
  }
}

/// The records of a team's particles: offset in the cell, mass, and the shares of all components.
template <class Sch>
struct Records {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  static constexpr bool with_d = Sch::p2g_moments, with_g = Sch::p2g_slopes;
  static constexpr int of_component = 1 + (with_d ? Dim : 0) + (with_g ? Dim : 0), used = Dim + 1 + Dim * of_component;
  // Neighbours in storage mostly stand in one cell, and the threads that read at a time read a particle of as many cells: particles eight
  // apart lie beside each other, at distances that spread reads and writes over all banks of the memory.
  static constexpr int size = used | 1, apart = 8;
  static constexpr int slots(int capacity) { return apart * group(capacity); }
  static constexpr int group(int capacity) { return capacity / apart + (sizeof(T) == 4 ? 4 : 2); }

  /// Where the record of particle i begins.
  template <int capacity>
  static JAXMPM_INLINE int place(int i) {
    return (i % apart * group(capacity) + i / apart) * size;
  }
};

/// What turns a particle's mass into its gifts: m Δx C goes with d; −Δt V σ / Δx with g or, mls, −Δt V σ D⁻¹ Δx / Δx² with d.
template <class Sch>
struct ScatterScales {
  using T = typename Sch::T;
  T affine, impulse;  // Δx; −Δt / (ρ0 Δx), of a particle with V = m / (ρ0 (1 + e))
  JAXMPM_INLINE ScatterScales(const StepConstants<T>& step, T density)
      : affine(step.cell_size), impulse(-step.dt * (Sch::mls ? T(1 / Bspline<Sch::S>::second_moment) : T(1)) / step.cell_size / density) {}
};

/// Writes a particle's record.
template <class Sch, class Law>
JAXMPM_INLINE void write_record(const ParticleFields<typename Sch::T, Sch::Dim>& f, std::size_t p, const Cell<Sch>& cell, const Law& law,
                                const ScatterScales<Sch>& scales, typename Sch::T* record) {
  using T = typename Sch::T;
  constexpr int Dim = Sch::Dim, history = Law::template history_size<Dim>();
  T h[history > 0 ? history : 1];
  for (int k = 0; k < history; ++k) h[k] = f.history(k, p);
  const T e = f.compression(p), mass = f.mass(p);
  const Symmetric<T, Dim> sigma = law.template stress<T, Dim>(e, h);
  const T by_stress = mass * scales.impulse / (T(1) + e), by_affine = mass * scales.affine;
  for (int k = 0; k < Dim; ++k) *record++ = cell.offset[k];
  *record++ = mass;
  for (int c = 0; c < Dim; ++c) {
    *record++ = mass * f.velocity(c, p);
    for (int k = 0; k < Dim; ++k) {
      const T impulse = by_stress * sigma(c, k);
      T affine(0);
      if constexpr (Sch::affine) affine = by_affine * f.affine(c * Dim + k, p);
      if constexpr (Sch::p2g_moments) record[k] = Sch::mls ? affine + impulse : affine;
      if constexpr (Sch::p2g_slopes) record[(Sch::p2g_moments ? Dim : 0) + k] = impulse;
    }
    record += Records<Sch>::of_component - 1;
  }
}

/// The arena of a team in its own memory, value by value (mass, momentum; FLIP: impulse): the threads of a warp add one value at the base
/// nodes of neighbouring cells at a time, and the distance of layers (in 2D rows) spreads these over all banks of the memory.
template <class Sch>
struct SpreadArena {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, A = Sch::Shape::A, within = Sch::Shape::arena_nodes / A;
  static constexpr int layer = within + ((Dim == 2 ? 8 : 4) - within % 32 + 32) % 32, plane = A * layer;
  static constexpr int size = plane * (1 + Dim * Sch::planes);

  static constexpr JAXMPM_INLINE int place(int node) { return node / within * layer + node % within; }
  static constexpr JAXMPM_INLINE int value(int v) { return v * plane; }

  /// Copies it to the tile's place among the arenas.
  template <class Team>
  static JAXMPM_INLINE void hand_in(const Team& team, const T* arena, T* out) {
    team_for(team, Sch::Shape::arena_nodes, [&](int node) {
      for (int p = 0; p < Sch::planes; ++p) {
        Quad<T> q{};
        if (p == 0) q.a[0] = arena[place(node)];
        for (int c = 0; c < Dim; ++c) q.a[1 + c] = arena[value(1 + p * Dim + c) + place(node)];
        quad_at(out + p * Sch::arena_plane, node) = q;
      }
    });
  }
};

/// The tile's place among the arenas itself, for arenas that a team's memory has no room for.
template <class Sch>
struct PlainArena {
  using T = typename Sch::T;
  static constexpr int size = Sch::arena_size;
  static constexpr JAXMPM_INLINE int place(int node) { return 4 * node; }
  static constexpr JAXMPM_INLINE int value(int v) { return v <= Sch::Dim ? v : Sch::arena_plane + v - Sch::Dim; }
  template <class Team>
  static JAXMPM_INLINE void hand_in(const Team&, const T*, T*) {}
};

/// The mass or one component of a cell's particles, summed at the nodes of their stencil.
template <class Sch, class Arena>
class CellSums {
  using T = typename Sch::T;
  using R = Records<Sch>;
  static constexpr int Dim = Sch::Dim, nodes = StencilNodes<Sch>::all;
  T sum_[nodes] = {}, impulse_[Sch::flip ? nodes : 1] = {};

 public:
  static constexpr int components = 1 + Dim;  // 0: mass

  JAXMPM_INLINE void add(const T* record, int component) {
    T offset[Dim];
    for (int k = 0; k < Dim; ++k) offset[k] = record[k];
    const Factors<Sch> s(offset);
    Share<T, Dim> q;
    if (component == 0) {
      q.plain = record[Dim];
      add_share<false, false>(s, q, sum_);
      return;
    }
    record += Dim + 1 + (component - 1) * R::of_component;
    q.plain = record[0];
    for (int k = 0; k < Dim; ++k) {
      if constexpr (R::with_d) q.d[k] = record[1 + k];
      if constexpr (R::with_g) q.g[k] = record[1 + (R::with_d ? Dim : 0) + k];
    }
    if constexpr (Sch::flip) {
      add_share<false, false>(s, q, sum_);
      q.plain = T(0);
      add_share<R::with_d, R::with_g>(s, q, impulse_);
    } else {
      add_share<R::with_d, R::with_g>(s, q, sum_);
    }
  }

  /// Adds the sums to the team's arena, where the stencil begins at node `base`.
  JAXMPM_INLINE void give(T* arena, int base, int component) const {
    T* first = arena + Arena::value(component) + Arena::place(base);
    T* second = arena + Arena::value(component + Dim) + Arena::place(base);
    JAXMPM_UNROLL
    for (int n = 0; n < nodes; ++n) {
      const int node = Arena::place(StencilNodes<Sch>::at(n));
      Kokkos::atomic_add(first + node, sum_[n]);
      if constexpr (Sch::flip)
        if (component > 0) Kokkos::atomic_add(second + node, impulse_[n]);
    }
  }
};

}  // namespace jaxmpm
