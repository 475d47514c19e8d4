#pragma once
// contract.hpp in 3D.
#include <initializer_list>
#include <type_traits>

#include "kernels/adjoint/row_sums.hpp"
#include "kernels/gather_3d.hpp"

namespace jaxmpm {

/// sums[j] += ∂f/∂X_j of one particle (lane l), one pack per axis: still to be added over its lanes. `rest`, `moments`, `slopes`: the
/// particle's groups A, B_0 and C_0, −1 where there are none. Where f depends on an axis only through its own factor, that factor is
/// replaced by its derivative: w by g, d by d', g by g'. `gathered`, where it is not null, receives what gather_3d() finds in the same nodes.
template <class Sch, int rest, int moments, int slopes, class Stencil, class Sums>
JAXMPM_INLINE void contract_3d(const StencilRows3d<Sch>& rows, const Stencil& t, int l, const typename Sch::T* groups,
                               typename StencilRows3d<Sch>::R* sums, Sums gathered) {
  using T = typename Sch::T;
  using Row = QuadRow<T, Sch::S>;
  constexpr int S = Sch::S, N = Row::N, last = 2;
  using R = Pack<T, N>;
  const T* z = t.last.row(l);
  static_for<Row::pieces>([&](auto piece) JAXMPM_INLINE_LAMBDA {
    constexpr int c = piece;
    const auto gather_from = [&](const R& w_sum, std::initializer_list<R> d_sums, std::initializer_list<R> g_sums) {
      if constexpr (!std::is_null_pointer_v<Sums>)
        gather_last_axis<Sch, c, (moments >= 0), (slopes >= 0), Stencil>(z, w_sum, d_sums.begin(), g_sums.begin(), gathered);
    };
    const R w = spread_quad<Stencil::w_quad, c, N>(z), g = spread_quad<Stencil::g_quad, c, N>(z);
    R line(T(0)), line_by_z(T(0));  // what goes with w on all axes but the last, and its derivative by the last
    if constexpr (rest >= 0) {
      const R A = repeat_quad<rest, N>(groups);
      line = w * A, line_by_z = g * A;
    }
    if constexpr (moments >= 0) {
      const R B = repeat_quad<moments + last, N>(groups);
      line += spread_quad<Stencil::d_quad, c, N>(z) * B, line_by_z += spread_quad<Stencil::dd_quad, c, N>(z) * B;
    }
    if constexpr (slopes >= 0) {
      const R C = repeat_quad<slopes + last, N>(groups);
      line += g * C, line_by_z += spread_quad<Stencil::gg_quad, c, N>(z) * C;
    }
    R moment[2], moment_by_z[2], slope[2], slope_by_z[2];  // what goes with d or g on one of the other axes
    static_for<2>([&](auto axis) JAXMPM_INLINE_LAMBDA {
      constexpr int k = axis;
      if constexpr (moments >= 0) {
        const R B = repeat_quad<moments + k, N>(groups);
        moment[k] = w * B, moment_by_z[k] = g * B;
      }
      if constexpr (slopes >= 0) {
        const R C = repeat_quad<slopes + k, N>(groups);
        slope[k] = w * C, slope_by_z[k] = g * C;
      }
    });
    const auto f = [&] {
      if constexpr (S == 3) return sum_quadratic_rows<c, (moments >= 0)>(rows, t, l);
      else return sum_rows<c, (moments >= 0), (slopes >= 0)>(rows, t, l);
    }();
    gather_from(f.ww, {f.dw, f.wd}, {f.gw, f.wg});
    sums[0] += f.gw * line, sums[1] += f.wg * line, sums[2] += f.ww * line_by_z;
    if constexpr (moments >= 0) {
      sums[0] += f.ddw * moment[0], sums[1] += f.dg * moment[0], sums[2] += f.dw * moment_by_z[0];
      sums[0] += f.gd * moment[1], sums[1] += f.wdd * moment[1], sums[2] += f.wd * moment_by_z[1];
    }
    if constexpr (slopes >= 0) {
      sums[0] += f.gg_w * slope[0], sums[1] += f.g_g * slope[0], sums[2] += f.gw * slope_by_z[0];
      sums[0] += f.g_g * slope[1], sums[1] += f.w_gg * slope[1], sums[2] += f.wg * slope_by_z[1];
    }
  });
}

/// Sums by place of W particles (one pack an axis): four lanes each, still to be added.
template <class Sch>
struct PlaceSums {
  using T = typename Sch::T;
  static constexpr int N = QuadRow<T, Sch::S>::N, per_store = N / 4;
  static constexpr int padded = round_up(3, per_store);
  ParticleRows<T, 4 * padded> rows;

  /// Takes the packs of one particle.
  JAXMPM_INLINE void put(int lane, const Pack<T, N>* sums) {
    for (int i = 0; i < padded; i += per_store) sum_quads(sums + i).store(rows.row(lane) + 4 * i);
  }
  /// Adds them to the derivatives by position.
  JAXMPM_INLINE void add_to(Particles<T, 3>& bar, std::size_t s, int count) {
    rows.clear_behind(count);
    Pack<T, batch<T>> packs[decltype(rows)::stride];
    rows.read(packs);
    for (int j = 0; j < 3; ++j) {
      const auto sum = (packs[4 * j] + packs[4 * j + 1]) + (packs[4 * j + 2] + packs[4 * j + 3]);
      add_to_places(bar.position[std::size_t(j)].data() + s, count, sum);
    }
  }
};

/// See Contraction2d.
template <class Sch>
class Contraction3d : Gather3d<Sch> {
  using Base = Gather3d<Sch>;
  using T = typename Sch::T;
  using R = typename StencilRows3d<Sch>::R;
  static constexpr int W = batch<T>;

 public:
  explicit Contraction3d(const Nodes3d<Sch>& nodes) : Base(nodes) {}

  template <class Stencil, class Bars>
  struct Sums {};

  template <class Bars, class Stencil>
  JAXMPM_INLINE void gather(const Stencil& t, int count, Pack<T, W>* gathered, Sums<Stencil, Bars>&) {
    Base::template gather<Bars>(t, count, gathered);
  }

  template <class Terms, class Stencil, class Bars>
  JAXMPM_INLINE void add_by_place(const Stencil& t, std::size_t s, int count, const Values3d<T, Terms>& values, Sums<Stencil, Bars>&,
                                  Particles<T, 3>& bar) {
    PlaceSums<Sch> by_place;
    for (int l = 0; l < count; ++l) {
      const StencilRows3d<Sch>* rows = this->nodes_.at(t.base[l]);
      R place[PlaceSums<Sch>::padded];
      for (R& x : place) x = R(T(0));
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane);
        contract_3d<Sch, of.rest, of.moments, of.slopes>(rows[plane], t, l, values.rows.row(l), place, nullptr);
      });
      by_place.put(l, place);
    }
    by_place.add_to(bar, s, count);
  }

  /// In one pass, as the nodes are at hand.
  template <class Bars, class Terms, class Stencil>
  JAXMPM_INLINE void contract(const Stencil& t, std::size_t s, int count, const Values3d<T, Terms>& values, Pack<T, W>* gathered,
                              Particles<T, 3>& bar) {
    constexpr int per_store = R::lanes / 4, groups = Bars::size / 4, padded = round_up(groups, per_store);
    ParticleRows<T, 4 * padded> by_value;
    PlaceSums<Sch> by_place;
    for (int l = 0; l < count; ++l) {
      const StencilRows3d<Sch>* rows = this->nodes_.at(t.base[l]);
      R sums[padded], place[PlaceSums<Sch>::padded];
      for (int i = groups; i < padded; ++i) sums[i] = R(T(0));
      for (R& x : place) x = R(T(0));
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr PlaneTerms of = Terms::in_plane(plane), to = Bars::in_plane(plane);
        static_assert((to.moments >= 0) == (of.moments >= 0) && (to.slopes >= 0) == (of.slopes >= 0));
        contract_3d<Sch, of.rest, of.moments, of.slopes>(rows[plane], t, l, values.rows.row(l), place, sums + to.rest);
      });
      for (int i = 0; i < padded; i += per_store) sum_quads(sums + i).store(by_value.row(l) + 4 * i);
      by_place.put(l, place);
    }
    by_value.clear_behind(count);
    by_value.read(gathered);
    by_place.add_to(bar, s, count);
  }
};

}  // namespace jaxmpm
