#pragma once
// The grid between the transfers (Eqs 13–14): sums of the arenas, division, gravity, walls and obstacles; and the copy of the result to a
// tile's arena.
#include <cstring>
#include <type_traits>

#include "contact/obstacles.hpp"
#include "contact/walls.hpp"
#include "core/pack.hpp"
#include "kernels/scheme.hpp"

namespace jaxmpm {

/// Distances a, b, c ∈ {−1, 0, 1} of neighbour m of a block (c = 0 in 2D).
template <int Dim>
struct NeighbourOffset {
  int a, b, c;
  explicit constexpr NeighbourOffset(int m)
      : a(Dim == 2 ? m / 3 - 1 : m / 9 - 1), b(Dim == 2 ? m % 3 - 1 : m / 3 % 3 - 1), c(Dim == 2 ? 0 : m % 3 - 1) {}
};

/// Rows (runs along the last axis) that the arena of neighbour M shares with a block: f(own node, arena node, count). The neighbour is a
/// compile-time number, so that a row is a few vectors and not a loop; `count` is an integral constant.
template <class Shape, int Dim, int S, int M, class F>
JAXMPM_INLINE void for_each_shared_row(F f) {
  constexpr NeighbourOffset<Dim> n(M);
  constexpr Overlap x = overlap<Shape::B, S>(n.a), y = overlap<Shape::B, S>(n.b), z = overlap<Shape::B, S>(n.c);
  if constexpr (Dim == 2) {
    constexpr std::integral_constant<int, y.count> count;
    for (int i = 0; i < x.count; ++i) f(Shape::own_node(x.from + i, y.from, 0), Shape::arena_node(x.in_arena + i, y.in_arena, 0), count);
  } else {
    constexpr std::integral_constant<int, z.count> count;
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j)
        f(Shape::own_node(x.from + i, y.from + j, z.from), Shape::arena_node(x.in_arena + i, y.in_arena + j, z.in_arena), count);
  }
}

/// Adds what the arena of neighbour M holds of a block's own nodes.
template <class Sch, int M>
JAXMPM_INLINE void add_shared_rows(const typename Sch::T* arena, typename Sch::T* own) {
  using T = typename Sch::T;
  for (int plane = 0; plane < Sch::planes; ++plane)
    for_each_shared_row<typename Sch::Shape, Sch::Dim, Sch::S, M>([&](int own_node, int arena_node, auto count) {
      const T* in = arena + plane * Sch::arena_plane + 4 * arena_node;
      T* out = own + plane * Sch::own_plane + 4 * own_node;
      for (int i = 0; i < 4 * count; ++i) out[i] += in[i];
    });
}

/// Adds the arenas that reach block b, in their fixed order. own: [plane][node][4].
template <class Sch>
void sum_arenas(const Blocks<Sch::Dim>& blocks, std::size_t b, const typename Sch::T* arenas, typename Sch::T* own) {
  using T = typename Sch::T;
  std::memset(own, 0, sizeof(T) * Sch::own_size);
  for (std::uint32_t k = blocks.first_contribution[b]; k < blocks.first_contribution[b + 1]; ++k) {
    const Contribution& from = blocks.contributions[k];
    const T* arena = arenas + std::size_t(from.tile) * Sch::arena_size;
    static_for<Sch::Shape::neighbours>([&](auto m) {
      if (int(from.neighbour) == m) add_shared_rows<Sch, m>(arena, own);
    });
  }
}

/// Rows of the nodes around a tile's block: f(block that owns them, own node, arena node, count).
template <class Sch, class F>
JAXMPM_INLINE void for_each_row_around(const Blocks<Sch::Dim>& blocks, std::size_t block, F f) {
  static_for<Sch::Shape::neighbours>([&](auto m) {
    const auto from = std::size_t(blocks.neighbour[block * Sch::Shape::neighbours + std::size_t(m)]);
    constexpr int mirrored = Sch::Shape::neighbours - 1 - m;  // the neighbour at the opposite distance: what it shares is what we take
    for_each_shared_row<typename Sch::Shape, Sch::Dim, Sch::S, mirrored>(
        [&](int own_node, int arena_node, auto count) { f(from, own_node, arena_node, count); });
  });
}

/// What the nodes of a step need besides their sums.
template <class T, int Dim>
struct GridConstants {
  Vector<T, Dim> gravity_step;  // Δt g, m/s
  T mass_cut_off;
  T damped;  // part of the velocity that damping takes in a step, ζΔt/(1 + ζΔt)
};

/// Those of a step of length `dt`, s.
template <class T, int Dim>
GridConstants<T, Dim> grid_constants(const Model& model, T mass_cut_off, double dt) {
  const double loss = model.method.damping * dt;
  GridConstants<T, Dim> constants{{}, mass_cut_off, T(loss / (1 + loss))};
  for (int c = 0; c < Dim; ++c) constants.gravity_step[c] = T(dt * model.gravity[std::size_t(c)]);
  return constants;
}

/// One node where no wall is near: P = (p + Δt f + Δt m g)/(1 + ζΔt), v = P / m. Sums become velocities in place ({m, v}, and
/// {–, v − p/m} in the second quad `change` where there is one), Σ m θ the mean of θ.
template <class Sch>
JAXMPM_INLINE void update_node(typename Sch::T* v, typename Sch::T* change, const GridConstants<typename Sch::T, Sch::Dim>& grid) {
  using T = typename Sch::T;
  const bool some = v[0] > grid.mass_cut_off;
  const T inverse = some ? T(1) / v[0] : T(0);
  if constexpr (Sch::dilation) (Sch::dilation_plane == 0 ? v : change)[Sch::dilation_lane] *= inverse;
  for (int c = 0; c < Sch::Dim; ++c) {
    const T pull = some ? grid.gravity_step[c] : T(0);
    if constexpr (Sch::planes == 2) {
      change[1 + c] = change[1 + c] * inverse + pull;
      v[1 + c] = v[1 + c] * inverse + change[1 + c];
      change[1 + c] -= grid.damped * v[1 + c];
    } else {
      v[1 + c] = v[1 + c] * inverse + pull;
    }
    v[1 + c] -= grid.damped * v[1 + c];
  }
}

/// The same for the nodes of a block, from `sums` to `own`, which may be the same.
template <class Sch>
void update_nodes(const typename Sch::T* sums, typename Sch::T* own, const GridConstants<typename Sch::T, Sch::Dim>& grid) {
  using Quad = Pack<typename Sch::T, 4>;
  for (int node = 0; node < Sch::Shape::cells; ++node) {
    for (int plane = 0; plane < Sch::planes; ++plane) {
      const int at = plane * Sch::own_plane + 4 * node;
      Quad::load(sums + at).store(own + at);
    }
    update_node<Sch>(own + 4 * node, own + (Sch::planes - 1) * Sch::own_plane + 4 * node, grid);
  }
}

}  // namespace jaxmpm
