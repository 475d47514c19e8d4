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

/// What particles give to the nodes in a step, {mass, momentum} or with FLIP a second plane's impulse: the `Gift` of the templates below.
template <class Sch, class Law>
class StepGift {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  Law law_;
  T affine_, impulse_;  // Δx of m Δx C, which goes with d; −Δt / (ρ0 Δx) of V = m / (ρ0 (1 + e)): −Δt V σ / Δx goes with g or, mls,
                        // −Δt V σ D⁻¹ Δx / Δx² with d

 public:
  static constexpr bool mass = true;                                          // as component 0
  static constexpr bool with_d = Sch::p2g_moments, with_g = Sch::p2g_slopes;  // factors besides the weight
  static constexpr bool second_plain = false;                                 // something goes with w to the second plane
  static constexpr int full = Sch::flip ? 1 : 0;                              // the plane that gets what goes with d and g
  JAXMPM_INLINE StepGift(const Law& law, const StepConstants<T>& step)
      : law_(law), affine_(step.cell_size), impulse_(-step.dt * Sch::gradient_scale / step.cell_size / law.density) {}

  /// A particle's shares of mass, which goes with the weight alone, and of momentum; with FLIP what goes with d and g is the second
  /// plane's.
  JAXMPM_INLINE void share(const ParticleFields<T, Dim>& f, std::size_t p, Share<T, Dim> (&shares)[1 + Dim]) const {
    constexpr int history = Law::template history_size<Dim>();
    T h[history > 0 ? history : 1];
    for (int k = 0; k < history; ++k) h[k] = f.history(k, p);
    const T e = f.compression(p), mass = f.mass(p);
    const Symmetric<T, Dim> sigma = law_.template stress<T, Dim>(e, h);
    const T by_stress = mass * impulse_ / (T(1) + e), by_affine = mass * affine_;
    shares[0].plain = mass;
    for (int c = 0; c < Dim; ++c) {
      Share<T, Dim>& q = shares[1 + c];
      q.plain = mass * f.velocity(c, p);
      for (int k = 0; k < Dim; ++k) {
        const T impulse = by_stress * sigma(c, k);
        T affine(0);
        if constexpr (Sch::affine) affine = by_affine * f.affine(c * Dim + k, p);
        if constexpr (with_d) q.d[k] = Sch::mls ? affine + impulse : affine;
        if constexpr (with_g) q.g[k] = impulse;
      }
    }
  }

  /// Writes a particle's record: its offset in the cell, its mass, and the share of each component.
  JAXMPM_INLINE void write(const ParticleFields<T, Dim>& f, std::size_t p, const Cell<Sch>& cell, T* record) const {
    Share<T, Dim> shares[1 + Dim];
    share(f, p, shares);
    for (int k = 0; k < Dim; ++k) *record++ = cell.offset[k];
    *record++ = shares[0].plain;
    for (int c = 1; c <= Dim; ++c) {
      *record++ = shares[c].plain;
      if constexpr (with_d)
        for (int k = 0; k < Dim; ++k) *record++ = shares[c].d[k];
      if constexpr (with_g)
        for (int k = 0; k < Dim; ++k) *record++ = shares[c].g[k];
    }
  }
};

/// The records of a team's particles: offset in the cell, mass where it is given, and the shares of all components.
template <class Sch, class Gift>
struct Records {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim;
  static constexpr int plain = 1 + int(Gift::second_plain), of_component = plain + (Gift::with_d ? Dim : 0) + (Gift::with_g ? Dim : 0);
  static constexpr int first = Dim + int(Gift::mass), used = first + Dim * of_component;
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

/// The mass or one component of what a cell's particles give, summed at the nodes of their stencil.
template <class Sch, class Gift, class Arena>
class CellSums {
  using T = typename Sch::T;
  using R = Records<Sch, Gift>;
  static constexpr int Dim = Sch::Dim, nodes = StencilNodes<Sch>::all, with_mass = int(Gift::mass);
  static constexpr bool with_d = Gift::with_d, with_g = Gift::with_g;
  T sum_[nodes] = {}, second_[Sch::flip ? nodes : 1] = {};

 public:
  static constexpr int components = with_mass + Dim;  // 0: mass where it is given

  JAXMPM_INLINE void add(const T* record, int component) {
    T offset[Dim];
    for (int k = 0; k < Dim; ++k) offset[k] = record[k];
    const Factors<Sch> s(offset);
    Share<T, Dim> q;
    if (component < with_mass) {
      q.plain = record[Dim];
      add_share<false, false>(s, q, sum_);
      return;
    }
    record += R::first + (component - with_mass) * R::of_component;
    q.plain = record[0];
    for (int k = 0; k < Dim; ++k) {
      if constexpr (with_d) q.d[k] = record[R::plain + k];
      if constexpr (with_g) q.g[k] = record[R::plain + (with_d ? Dim : 0) + k];
    }
    if constexpr (Gift::full == 1) {
      add_share<false, false>(s, q, sum_);
      q.plain = T(0);
      add_share<with_d, with_g>(s, q, second_);
    } else {
      add_share<with_d, with_g>(s, q, sum_);
      if constexpr (Gift::second_plain) q.plain = record[1], add_share<false, false>(s, q, second_);
    }
  }

  /// Adds the sums to the team's arena, where the stencil begins at node `base`.
  JAXMPM_INLINE void give(T* arena, int base, int component) const {
    const int value = component + 1 - with_mass;
    T* first = arena + Arena::value(value) + Arena::place(base);
    T* second = arena + Arena::value(value + Dim) + Arena::place(base);
    JAXMPM_UNROLL
    for (int n = 0; n < nodes; ++n) {
      const int node = Arena::place(StencilNodes<Sch>::at(n));
      Kokkos::atomic_add(first + node, sum_[n]);
      if constexpr (Sch::flip)
        if (value > 0) Kokkos::atomic_add(second + node, second_[n]);
    }
  }
};

}  // namespace jaxmpm
