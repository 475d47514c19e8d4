#pragma once
// What particles find in the nodes around them, in 3D (stencil_3d.hpp).
#include <algorithm>

#include "kernels/grid.hpp"
#include "kernels/scatter_3d.hpp"

namespace jaxmpm {

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

/// The nodes around a tile: [plane][node][4].
template <class Sch>
struct Nodes3d {
  using T = typename Sch::T;
  alignas(64) T value[Sch::arena_size];

  /// `grid`: [block][plane][own node][4].
  Nodes3d(const Blocks<3>& blocks, std::size_t block, const T* grid) {
    constexpr int filled = 4 * Sch::Shape::arena_nodes;
    // Rows read on behind the last node, with weight zero: what lies there must be finite.
    for (int plane = 0; plane < Sch::planes; ++plane)
      std::fill(value + plane * Sch::arena_plane + filled, value + (plane + 1) * Sch::arena_plane, T(0));
    for_each_row_around<Sch>(blocks, block, [&](std::size_t from, int own_node, int arena_node, auto count) {
      for (int plane = 0; plane < Sch::planes; ++plane)
        std::memcpy(value + plane * Sch::arena_plane + 4 * arena_node, grid + from * Sch::own_size + plane * Sch::own_plane + 4 * own_node,
                    sizeof(T) * 4 * std::size_t(count));
    });
  }
};

/// The stencils of a tile's nodes, a particle after the other.
template <class Sch>
class NodeRows3d {
  using T = typename Sch::T;

 public:
  explicit NodeRows3d(const Nodes3d<Sch>& nodes) : nodes_(nodes) {
    for (auto& r : rows_) r.clear();
  }
  /// The rows of all planes at a base node.
  JAXMPM_INLINE const StencilRows3d<Sch>* at(int base) {
    for (int plane = 0; base != loaded_ && plane < Sch::planes; ++plane)
      rows_[plane].load(nodes_.value + plane * Sch::arena_plane + base * 4);
    loaded_ = base;
    return rows_;
  }

 private:
  const Nodes3d<Sch>& nodes_;
  StencilRows3d<Sch> rows_[Sch::planes];
  int loaded_ = -1;
};

/// Gathers from the nodes around a tile.
template <class Sch>
class Gather3d {
  using T = typename Sch::T;
  using R = typename StencilRows3d<Sch>::R;

 public:
  explicit Gather3d(const Nodes3d<Sch>& nodes) : nodes_(nodes) {}

  /// Σ over the stencil of factor × node for `count` particles (those of the stencils t), in the groups of Terms; lanes behind them repeat
  /// the last.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int count, Pack<T, batch<T>>* sums) {
    constexpr int per_store = R::lanes / 4, padded = round_up(Terms::size / 4, per_store);
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

 protected:
  NodeRows3d<Sch> nodes_;
};

}  // namespace jaxmpm
