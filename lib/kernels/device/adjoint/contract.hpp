#pragma once
// What the adjoints of both transfers share on a device: f(X) = Σ_i [w_i A + Σ_k (d_k)_i B_k + Σ_k (g_k)_i C_k] · N_i by a particle's
// position (kernels/adjoint/contract.hpp), and where all teams add up derivatives by constants.
#include "kernels/adjoint/material_adjoint.hpp"
#include "kernels/device/shares.hpp"

namespace jaxmpm {

/// Factors along one axis at one node, and their derivatives by X: w' = g, d' = g (X_i − X_p) − w, g'.
template <class T>
struct NodeFactors {
  T w, d, g, dd, gg;
};

/// Adds to by_x the derivatives by position of Σ_i factor_i · N_i over a stencil. N: values `first` … of the records of an arena's plane,
/// which the stencil begins at `base`; shares[c] is what goes with value first + c, of the first `plain` of them with the weight alone.
template <class Sch, bool with_d, bool with_g, int first, int count, int plain = 0>
class Contraction {
  using T = typename Sch::T;
  static constexpr int Dim = Sch::Dim, S = Sch::S, last = Dim - 1;
  const Factors<Sch>& factors_;
  const T (&offset_)[Dim];
  const Share<T, Dim>* shares_;
  T curvature_[Dim][S];

  /// Σ_c N_c A_c, N_c B_kc and N_c C_kc at a node.
  struct Node {
    T a = 0, b[Dim] = {}, c[Dim] = {};
    JAXMPM_INLINE Node(const Quad<T>& n, const Share<T, Dim>* shares) {
      for (int v = 0; v < count; ++v) {
        const T value = n.a[first + v];
        a += value * shares[v].plain;
        for (int k = 0; k < Dim && v >= plain; ++k) {
          if constexpr (with_d) b[k] += value * shares[v].d[k];
          if constexpr (with_g) c[k] += value * shares[v].g[k];
        }
      }
    }
  };
  /// Sums along a row of nodes on the last axis: what goes with w on the axes before (by_z: its derivative by that axis), and what goes
  /// with d or g on one of them.
  struct Row {
    T line = 0, by_z = 0, b[last] = {}, b_by_z[last] = {}, c[last] = {}, c_by_z[last] = {};
  };

  JAXMPM_INLINE NodeFactors<T> at(int axis, int i) const {
    const Factors<Sch>& f = factors_;
    return {f.w[axis][i], f.d[axis][i], f.g[axis][i], f.g[axis][i] * (T(i) - offset_[axis]) - f.w[axis][i], curvature_[axis][i]};
  }
  /// The same with an index that is known when it runs: a choice, as an array would have to lie in memory.
  JAXMPM_INLINE NodeFactors<T> choose(int axis, int i) const {
    NodeFactors<T> f = at(axis, 0);
    JAXMPM_UNROLL
    for (int k = 1; k < S; ++k)
      if (i == k) f = at(axis, k);
    return f;
  }

  JAXMPM_INLINE Row row(const T* nodes) const {
    Row r;
    JAXMPM_UNROLL
    for (int i = 0; i < S; ++i) {
      const Node n(quad_at(nodes, i), shares_);
      const NodeFactors<T> z = at(last, i);
      r.line += z.w * n.a, r.by_z += z.g * n.a;
      if constexpr (with_d) r.line += z.d * n.b[last], r.by_z += z.dd * n.b[last];
      if constexpr (with_g) r.line += z.g * n.c[last], r.by_z += z.gg * n.c[last];
      for (int k = 0; k < last; ++k) {
        if constexpr (with_d) r.b[k] += z.w * n.b[k], r.b_by_z[k] += z.g * n.b[k];
        if constexpr (with_g) r.c[k] += z.w * n.c[k], r.c_by_z[k] += z.g * n.c[k];
      }
    }
    return r;
  }
  /// Derivatives of w line + d b + g c of an axis: by itself, and of what stands beside its factors.
  static JAXMPM_INLINE T along(const NodeFactors<T>& f, T line, T b, T c) {
    T sum = f.w * line;
    if constexpr (with_d) sum += f.d * b;
    if constexpr (with_g) sum += f.g * c;
    return sum;
  }
  static JAXMPM_INLINE T along_derived(const NodeFactors<T>& f, T line, T b, T c) {
    T sum = f.g * line;
    if constexpr (with_d) sum += f.dd * b;
    if constexpr (with_g) sum += f.gg * c;
    return sum;
  }

 public:
  JAXMPM_INLINE Contraction(const Factors<Sch>& factors, const T (&offset)[Dim], const Share<T, Dim>* shares)
      : factors_(factors), offset_(offset), shares_(shares) {
    for (int axis = 0; axis < Dim; ++axis) Bspline<S>::curvatures(offset[axis], curvature_[axis]);
  }

  JAXMPM_INLINE void add(const T* plane, int base, T (&by_x)[Dim]) const {
    for (int i = 0; i < S; ++i) {
      const NodeFactors<T> x = choose(0, i);
      const T* layer = plane + 4 * (base + i * StencilNodes<Sch>::step(0));
      if constexpr (Dim == 2) {
        const Row r = row(layer);
        by_x[0] += along_derived(x, r.line, r.b[0], r.c[0]);
        by_x[1] += along(x, r.by_z, r.b_by_z[0], r.c_by_z[0]);
      } else {
        JAXMPM_UNROLL
        for (int j = 0; j < S; ++j) {
          const NodeFactors<T> y = at(1, j);
          const Row r = row(layer + 4 * j * StencilNodes<Sch>::step(1));
          const T line = along(y, r.line, r.b[1], r.c[1]);  // what goes with w of x
          by_x[0] += along_derived(x, line, y.w * r.b[0], y.w * r.c[0]);
          by_x[1] += along(x, along_derived(y, r.line, r.b[1], r.c[1]), y.g * r.b[0], y.g * r.c[0]);
          by_x[2] += along(x, along(y, r.by_z, r.b_by_z[1], r.c_by_z[1]), y.w * r.b_by_z[0], y.w * r.c_by_z[0]);
        }
      }
    }
  }
};

/// Calls each(p, its cell, arena) for the particles of the team's tile, a thread a particle; the arena, in the team's memory, holds what
/// `nodes` ([block][own]) has at the tile's nodes.
template <class Sch, class Team, class T, int Dim, class Each>
JAXMPM_INLINE void for_each_particle(const Team& team, const TileTable<T, Dim>& table, const int* neighbour, const T* nodes,
                                     const ParticleFields<T, Dim>& particles, const Each& each) {
  const Tile tile = table.tiles[team.league_rank()];
  const Index<Dim> origin = table.origin(tile);
  T* arena = team_memory<T>(team, Sch::arena_size);
  load_arena<Sch>(team, neighbour + std::size_t(tile.block) * Sch::Shape::neighbours, nodes, arena);
  team.team_barrier();
  for (std::size_t p = tile.begin + std::size_t(team.team_rank()); p < tile.end; p += std::size_t(team.team_size()))
    each(p, Cell<Sch>(Position<Dim>(particles, p), origin), arena);
}

/// Derivatives by constants, added up by all teams in a table of doubles: by the model's, then of each body by its law's constants, with
/// its count of kinks.
struct ConstantBars {
  static constexpr int gravity = 0, damping = 3, flip_fraction = 4, wall_velocity = 5, segment = wall_velocity + 18;
  static constexpr int of_body = MaterialReport::most_constants + 1, kinks = MaterialReport::most_constants;
  int segments, obstacles;
  JAXMPM_FUNCTION int obstacle() const { return segment + segments; }
  JAXMPM_FUNCTION int body(std::size_t b) const { return obstacle() + obstacles + of_body * int(b); }
};

/// One thread's share of a body's.
template <class Law>
struct MaterialBars {
  static constexpr int count = int(std::tuple_size_v<decltype(Law::constants(std::declval<Law&>()))>);
  static_assert(count <= MaterialReport::most_constants && Law::by_hand, "a device has no tape");
  double by_constants[count] = {}, kinks = 0;

  template <class T>
  JAXMPM_INLINE void add(const T (&by)[count]) {
    for (int k = 0; k < count; ++k) by_constants[k] += double(by[k]);
  }
  /// Adds those of all threads to the body's place in the table.
  template <class Team>
  JAXMPM_INLINE void give(const Team& team, double* body) const {
    for (int k = 0; k < count; ++k) give_sum(team, by_constants[k], body + k);
    give_sum(team, kinks, body + ConstantBars::kinks);
  }
  template <class Team>
  static JAXMPM_INLINE void give_sum(const Team& team, double mine, double* to) {
    const double sum = team_sum(team, mine);
    if (team.team_rank() == 0 && sum != 0) Kokkos::atomic_add(to, sum);
  }
};

/// A particle's compression and history, with the derivatives by them and by the law's constants.
template <class Law, class T, int Dim>
struct StateBars {
  static constexpr int history = Law::template history_size<Dim>(), slots = history > 0 ? history : 1;
  T e, by_e, h[slots], by_h[slots], by_constants[MaterialBars<Law>::count] = {};

  JAXMPM_INLINE StateBars(const ParticleFields<T, Dim>& particles, const ParticleFields<T, Dim>& bars, std::size_t p)
      : e(particles.compression(p)), by_e(bars.compression(p)) {
    for (int k = 0; k < history; ++k) h[k] = particles.history(k, p), by_h[k] = bars.history(k, p);
  }
  /// Writes the derivatives back; those by constants are added to the thread's.
  JAXMPM_INLINE void store(const ParticleFields<T, Dim>& bars, std::size_t p, MaterialBars<Law>& mine) const {
    bars.compression(p) = by_e;
    for (int k = 0; k < history; ++k) bars.history(k, p) = by_h[k];
    mine.add(by_constants);
  }
};

}  // namespace jaxmpm
