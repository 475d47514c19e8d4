#pragma once
// What particles find in the nodes around them, in 2D (stencil_2d.hpp).
#include <algorithm>

#include "kernels/grid.hpp"
#include "kernels/scatter_2d.hpp"

namespace jaxmpm {

/// The nodes around a tile, by kind of value: of each plane the pairs in the middle of its quads, and of the first the masses (if asked for)
/// and θ. A row of a stencil is then one load a kind, and takes no branch on whether the last particle had the same.
template <class Sch, bool Masses>
struct Nodes2d {
  using T = typename Sch::T;
  static constexpr int count = Sch::Shape::arena_nodes + 4;  // rows are read in whole packs: room behind the last
  alignas(64) T pair[Sch::planes][2 * count];
  alignas(64) T mass[Masses ? count : 1], theta[Sch::dilation ? count : 1];

  /// `grid`: [block][plane][own node][4].
  Nodes2d(const Blocks<2>& blocks, std::size_t block, const T* grid) {
    for_each_row_around<Sch>(blocks, block, [&](std::size_t from, int own_node, int arena_node, auto nodes) {
      for (int plane = 0; plane < Sch::planes; ++plane)
        for (int i = 0; i < nodes; ++i) {
          const T* quad = grid + from * Sch::own_size + plane * Sch::own_plane + 4 * (own_node + i);
          const int at = arena_node + i;
          Pack<T, 2>::load(quad + 1).store(pair[plane] + 2 * at);
          if constexpr (Masses) mass[at] = plane == 0 ? quad[0] : mass[at];
          if constexpr (Sch::dilation) theta[at] = plane == 0 ? quad[3] : theta[at];
        }
    });
    const auto clear_behind = [](T* values, int each) { std::fill(values + each * Sch::Shape::arena_nodes, values + each * count, T(0)); };
    for (auto& plane : pair) clear_behind(plane, 2);
    if constexpr (Masses) clear_behind(mass, 1);
    if constexpr (Sch::dilation) clear_behind(theta, 1);
  }
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

  /// `nodes`: the values of an arena's nodes, as Nodes2d has them. One component after the other, so that its sums stay in registers.
  JAXMPM_INLINE void sum(const Stencil& t, const typename P::Scalar* nodes) {
    constexpr int lanes = NodeRow<typename P::Scalar, S, C>::lanes;
    P node[S][lanes];
    static_for<S>([&](auto a) JAXMPM_INLINE_LAMBDA {
      load_columns<lanes>(node[a], [&](int l) { return nodes + C * (t.base[l] + Stencil::row(a)); });
    });
    static_for<C>([&](auto c) JAXMPM_INLINE_LAMBDA {
      static_for<S>([&](auto a) JAXMPM_INLINE_LAMBDA {
        static_for<kinds>([&](auto j) JAXMPM_INLINE_LAMBDA {
          if constexpr (asks_for_second(j)) {
            P line = t.factor[1][j][0] * node[a][c];
            for (int b = 1; b < S; ++b) line += t.factor[1][j][b] * node[a][C * b + c];
            static_for<kinds>([&](auto i) JAXMPM_INLINE_LAMBDA {
              if constexpr (asks_for(i, j)) at[i][j][c] = a == 0 ? t.factor[0][i][a] * line : at[i][j][c] + t.factor[0][i][a] * line;
            });
          }
        });
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
  JAXMPM_INLINE void sum(const Stencil& t, const Nodes2d<Sch, Masses>& nodes) {
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

/// Gathers from the nodes around a tile.
template <class Sch>
class Gather2d {
  using T = typename Sch::T;

 public:
  explicit Gather2d(const Nodes2d<Sch, false>& nodes) : nodes_(nodes) {}

  /// Σ over the stencil of factor × node for W particles (those of the stencils t), in the groups of Terms.
  template <class Terms, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int, Pack<T, batch<T>>* sums) {
    GatheredSums<Sch, Stencil, Terms, false, false> gathered;
    gathered.sum(t, nodes_);
    gathered.store(sums);
  }

 private:
  const Nodes2d<Sch, false>& nodes_;
};

}  // namespace jaxmpm
