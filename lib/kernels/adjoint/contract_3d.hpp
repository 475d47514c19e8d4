#pragma once
// contract.hpp in 3D.
#include "kernels/adjoint/spline_cells_3d.hpp"

namespace jaxmpm {

/// See Contraction2d. Masses: the first value of the first plane's quads is of interest.
template <class Sch, bool Masses>
class Contraction3d {
  using T = typename Sch::T;
  static constexpr int S = Sch::S, Dim = 3, W = batch<T>;
  using P = Pack<T, W>;
  using Place = SplinePlace<S, P>;

 public:
  explicit Contraction3d(const Nodes3d<Sch>& nodes) : gather_(nodes), cells_(nodes) {}

  template <bool moments, bool slopes>
  using ContractStencil = StencilPlaces3d<Sch>;
  template <bool moments, bool slopes>
  using GatherStencil = Stencils3d<Sch, moments, slopes>;
  template <class Stencil, class Bars>
  struct Sums {};

  template <class Bars, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int count, P* gathered, Sums<Stencil, Bars>&) {
    gather_.template gather<Bars>(t, count, gathered);
  }
  template <class Terms, class Stencil, class Bars>
  JAXMPM_INLINE void add_by_place(const Stencil& t, std::size_t s, int count, const P* values, Sums<Stencil, Bars>&,
                                  ParticleView<T, 3>& bar) {
    contract_nodes<void, Terms>(t, s, count, values, nullptr, bar);
  }
  template <class Bars, class Terms>
  JAXMPM_INLINE void contract(const StencilPlaces3d<Sch>& t, std::size_t s, int count, const P* values, P* gathered,
                              ParticleView<T, 3>& bar) {
    contract_nodes<Bars, Terms>(t, s, count, values, gathered, bar);
  }

 private:
  Gather3d<Sch> gather_;
  SplineCells3d<Sch> cells_;

  static constexpr bool uses_first(int plane) { return plane == 0 ? Masses : Sch::dilation; }
  static constexpr bool uses_others(int plane) { return plane == 0 || Sch::flip; }

  /// Bars void: nothing is gathered. A cell after the other, for all lanes at once; only those in it take what comes out.
  template <class Bars, class Terms>
  JAXMPM_INLINE void contract_nodes(const StencilPlaces3d<Sch>& t, std::size_t s, int count, const P* values, P* gathered,
                                    ParticleView<T, 3>& bar) {
    const Place place[Dim] = {Place(t.offset[0]), Place(t.offset[1]), Place(t.offset[2])};
    P by[Dim] = {P(T(0)), P(T(0)), P(T(0))}, left = convert<T>(Pack<int, W>::load(t.base));
    if constexpr (!std::is_void_v<Bars>)
      for (int i = 0; i < Bars::size; ++i) gathered[i] = P(T(0));
    for (T base = largest(left); base >= T(0); base = largest(left)) {
      const auto here = left == P(base);
      const T* cell = cells_.at(int(base));
      P sums[Dim] = {P(T(0)), P(T(0)), P(T(0))};
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane);
        const T* coefficient = cell + plane * SplineCells3d<Sch>::plane_stride;
        if constexpr (uses_first(plane)) contract_value<of.rest, -1, -1, Bars, plane>(coefficient, 0, place, here, values, gathered, sums);
        if constexpr (uses_others(plane))
          for (int c = 1; c <= Dim; ++c)
            contract_value<of.rest, of.moments, of.slopes, Bars, plane>(coefficient + c, c, place, here, values, gathered, sums);
      });
      for (int j = 0; j < Dim; ++j) by[j] = select(here, sums[j], by[j]);
      left = select(here, P(T(-1)), left);
    }
    for (int j = 0; j < Dim; ++j) add_to_places(bar.position[std::size_t(j)].data() + s, count, by[j]);
  }

  /// Value c of the nodes' quads. A moment Σ d n is of_slope times the slope and of_highest times the highest derivative (SplinePlace).
  template <int rest, int moments, int slopes, class Bars, int plane>
  JAXMPM_INLINE void contract_value(const T* coefficient, int c, const Place (&place)[Dim], Mask<T, W> here, const P* values, P* gathered,
                                    P* sums) {
    const auto f = field_at<S, SplineCells3d<Sch>::stride>(coefficient, place);
    const P of_slope{T(Place::of_slope)};
    const auto value = [&](int group) { return values[4 * group + c]; };
    const auto put = [&](int group, P sum) { gathered[4 * group + c] = select(here, sum, gathered[4 * group + c]); };
    if constexpr (rest >= 0)
      for (int j = 0; j < Dim; ++j) sums[j] += value(rest) * f.slope[j];
    for (int k = 0; k < Dim; ++k) {
      if constexpr (moments >= 0) {
        const P B = value(moments + k), of_highest = B * place[k].of_highest;
        for (int j = 0; j < Dim; ++j) sums[j] += j == k ? B * place[k].of_highest_slope * f.highest[k] : of_highest * f.highest_slope[k][j];
      }
      if constexpr (moments >= 0 || slopes >= 0) {
        P C(T(0));
        if constexpr (moments >= 0) C += of_slope * value(moments + k);
        if constexpr (slopes >= 0) C += value(slopes + k);
        for (int j = 0; j < Dim; ++j) sums[j] += C * f.curvature[k][j];
      }
    }
    if constexpr (!std::is_void_v<Bars>) {
      constexpr PlaneTerms to = Bars::in_plane(plane);
      static_assert(to.rest >= 0 && (moments < 0 || to.moments >= 0) && (slopes < 0 || to.slopes >= 0));
      put(to.rest, f.value);
      for (int k = 0; k < Dim; ++k) {
        if constexpr (moments >= 0) put(to.moments + k, of_slope * f.slope[k] + place[k].of_highest * f.highest[k]);
        if constexpr (slopes >= 0) put(to.slopes + k, f.slope[k]);
      }
    }
  }
};

}  // namespace jaxmpm
