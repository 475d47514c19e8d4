#pragma once
// What a transfer scheme needs, as compile-time facts, so that a kernel does nothing else.
#include "basis/bspline.hpp"
#include "core/pack.hpp"
#include "deck/deck.hpp"
#include "state/blocks.hpp"

namespace jaxmpm {

/// S: spline nodes; MLS: gradient form D⁻¹φ(x_i − x_p) instead of ∇φ; Dilation: a node has room for Σ m θ, then the mean of θ, the
/// particles' change of volume in the last step, where it is averaged (/method/volume_averaging).
///
/// Along one axis a particle has three kinds of factor for a node: the weight w, the moment d = w (X_i − X_p) and the slope g = dφ/dX. A
/// tensor-product quantity along axis k takes d or g on axis k and w on the others. Affine velocities go with d, forces and gradients with
/// g (spline) or d (mls).
template <class T_, int Dim_, int S_, deck::Transfer kTransfer, bool kMls, bool kDilation = false>
struct Scheme {
  using T = T_;
  static constexpr int Dim = Dim_, S = S_;
  static constexpr deck::Transfer transfer = kTransfer;
  static constexpr bool mls = kMls, dilation = kDilation;
  static_assert(!(mls && S == 2), "linear splines have no moment matrix");
  static constexpr bool flip = transfer == deck::Transfer::flip;
  /// APIC's affine matrix is B D⁻¹; with linear splines D is singular at nodes and ∇φ takes its place, which is TPIC.
  static constexpr bool affine_by_moments = transfer == deck::Transfer::apic && S > 2;
  static constexpr bool affine = transfer == deck::Transfer::apic || transfer == deck::Transfer::tpic;
  static constexpr bool p2g_moments = affine || mls, p2g_slopes = !mls;
  static constexpr bool g2p_moments = affine_by_moments || mls;
  static constexpr bool g2p_slopes = !mls || (affine && !affine_by_moments);
  /// What turns sums over nodes into gradients times Δx: D⁻¹ (Eq B.2) where they are of moments, 1 where they are of slopes.
  static constexpr T inverse_moment = T(S > 2 ? 1 / Bspline<S>::second_moment : 0);
  static constexpr T affine_scale = affine_by_moments ? inverse_moment : T(1), gradient_scale = mls ? inverse_moment : T(1);
  /// A node's record: one quad {mass, momentum or velocity}; FLIP has a second {–, impulse or change of velocity}. θ has the last place of
  /// the first quad in 2D and the first place of the second in 3D.
  static constexpr int planes = flip || (dilation && Dim == 3) ? 2 : 1;
  static constexpr int dilation_plane = Dim == 2 ? 0 : 1, dilation_lane = Dim == 2 ? 3 : 0;
  /// Values that go together in what a particle gives to or takes from a node: in 3D the whole quad, in 2D the momentum (velocity) alone.
  /// `vector_at`: where that begins among them.
  static constexpr int V = Dim == 2 ? 2 : 4, vector_at = Dim == 2 ? 0 : 1;
  using Shape = BlockShape<Dim, S>;
  static constexpr int arena_plane = (Shape::arena_nodes + 4) * 4;  // rows are read a full vector at a time: room behind the last
  static constexpr int arena_size = arena_plane * planes;
  static constexpr int own_plane = Shape::cells * 4;
  static constexpr int own_size = own_plane * planes;
};

/// Which groups of V values of a particle a plane of nodes takes or gives: `rest` goes with w alone, moments + k with d on axis k,
/// slopes + k with g on axis k; −1: not at all.
///
/// A class of terms has in_plane(plane); `size`, the number of values; and in 2D the places of single values that go with w: `mass` with the
/// first of a quad, `theta` with the last, −1 where there is none.
struct PlaneTerms {
  int rest, moments, slopes;
};

}  // namespace jaxmpm
