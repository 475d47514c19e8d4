#pragma once
// What the nodes around particles spline to, and its derivatives by the place, in 3D. Where particles share a base node it is a polynomial:
// its coefficients are found once for them, and all lanes of a batch take it, each at its own place.
#include "basis/spline_in_cell.hpp"
#include "kernels/gather_3d.hpp"

namespace jaxmpm {

/// Coefficients for the cells of a tile, found when they are asked for: those of a row of cells along the last axis at once, four values of
/// each cell side by side in the lanes.
template <class Sch>
class SplineCells3d {
  using T = typename Sch::T;
  using R = Pack<T, native_lanes<T>>;
  static constexpr int S = Sch::S, A = Sch::Shape::A, cells = R::lanes / 4;
  static_assert(cells <= 4, "rows are read to four nodes behind their end");

 public:
  /// [plane][first axis][second][last]; coefficient of value c of a cell: at its number × 4 + c.
  using Coefficients = R[Sch::planes][S][S][S];

  explicit SplineCells3d(const Nodes3d<Sch>& nodes) : nodes_(nodes) {}

  /// Those of the first value of the cell at a base node; the others' follow, and each order is R::lanes behind the one before.
  JAXMPM_INLINE const T* at(int base) {
    const int along = base % A, first = along < 1 ? 0 : (along - 1) / cells * cells + 1;  // from a block's first cell on, full rows
    if (base - along + first != first_) make(base - along + first);
    return reinterpret_cast<const T*>(coefficients_) + 4 * (along - first);
  }
  static constexpr int stride = R::lanes, plane_stride = S * S * S * R::lanes;

 private:
  const Nodes3d<Sch>& nodes_;
  Coefficients coefficients_;
  int first_ = -1;  // base node of the first cell they are of

  void make(int first) {
    first_ = first;
    for (int plane = 0; plane < Sch::planes; ++plane) {
      auto& c = coefficients_[plane];
      const T* from = nodes_.value + plane * Sch::arena_plane + 4 * first;
      for (int i = 0; i < S; ++i)
        for (int j = 0; j < S; ++j) {
          R node[S];
          for (int k = 0; k < S; ++k) node[k] = R::load(from + 4 * Sch::Shape::arena_node(i, j, k));
          spline_coefficients(node, c[i][j]);
        }
      const auto along_other_axis = [](auto at) {
        for (int i = 0; i < S; ++i)
          for (int k = 0; k < S; ++k) {
            R node[S], order[S];
            for (int a = 0; a < S; ++a) node[a] = at(i, a, k);
            spline_coefficients(node, order);
            for (int a = 0; a < S; ++a) at(i, a, k) = order[a];
          }
      };
      along_other_axis([&](int i, int a, int k) -> R& { return c[i][a][k]; });
      along_other_axis([&](int j, int a, int k) -> R& { return c[a][j][k]; });
    }
  }
};

/// A field at a place and its derivatives there, by cell: those by two axes, and with moments the highest one along each axis and its
/// derivatives by the others ([of the highest][other]).
template <class P>
struct FieldAt {
  P value, slope[3], curvature[3][3], highest[3], highest_slope[3][3];
};

/// From the coefficients of one value, `stride` apart.
template <int S, int stride, class P>
JAXMPM_INLINE FieldAt<P> field_at(const typename P::Scalar* coefficient, const SplinePlace<S, P> (&place)[3]) {
  const SplinePlace<S, P>&x = place[0], &y = place[1], &z = place[2];
  // Named by what is done along y and along z: v value, s slope, c curvature, h the highest derivative.
  SplineAt<P> vv, sv, cv, hv, vs, ss, hs, vc, vh, sh;
  static_for<S>([&](auto i) JAXMPM_INLINE_LAMBDA {
    SplineAt<P> v, s, c, h;  // by what is done along z
    static_for<S>([&](auto j) JAXMPM_INLINE_LAMBDA {
      SplineAt<P> line;
      static_for<S>([&](auto k) JAXMPM_INLINE_LAMBDA { z.template add<k>(line, P(coefficient[((i * S + j) * S + k) * stride])); });
      y.template add<j>(v, line.value), y.template add<j>(s, line.slope);
      y.template add<j>(c, line.curvature), y.template add<j>(h, line.highest);
    });
    x.template add<i>(vv, v.value), x.template add<i>(sv, v.slope), x.template add<i>(cv, v.curvature), x.template add<i>(hv, v.highest);
    x.template add<i>(vs, s.value), x.template add<i>(ss, s.slope), x.template add<i>(hs, s.highest);
    x.template add<i>(vc, c.value), x.template add<i>(vh, h.value), x.template add<i>(sh, h.slope);
  });
  FieldAt<P> f;
  const auto set_mixed = [&](int j, int k, P value) { f.curvature[j][k] = f.curvature[k][j] = value; };
  f.value = vv.value, f.slope[0] = vv.slope, f.slope[1] = sv.value, f.slope[2] = vs.value;
  f.curvature[0][0] = vv.curvature, f.curvature[1][1] = cv.value, f.curvature[2][2] = vc.value;
  set_mixed(0, 1, sv.slope), set_mixed(0, 2, vs.slope), set_mixed(1, 2, ss.value);
  f.highest[0] = vv.highest, f.highest_slope[0][1] = sv.highest, f.highest_slope[0][2] = vs.highest;
  f.highest[1] = hv.value, f.highest_slope[1][0] = hv.slope, f.highest_slope[1][2] = hs.value;
  f.highest[2] = vh.value, f.highest_slope[2][0] = vh.slope, f.highest_slope[2][1] = sh.value;
  return f;
}

}  // namespace jaxmpm
