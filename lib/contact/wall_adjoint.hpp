#pragma once
// Adjoint of the walls (walls.hpp) and of the obstacles (obstacles.hpp) at one node. Contact and stick are differentiated as taken.
#include "contact/obstacles.hpp"
#include "contact/walls.hpp"

namespace jaxmpm {

/// Adjoint of the friction that takes `loss` off a velocity t tangential to a surface: t ← t max(0, 1 − loss/|t|). In: derivatives by the
/// result; out: by t. Returns the derivative by the loss.
template <class T, int Dim>
JAXMPM_INLINE T rub_adjoint(const Vector<T, Dim>& t, T loss, Vector<T, Dim>& bar) {
  T square = 0, along = 0;
  for (int c = 0; c < Dim; ++c) square += t[c] * t[c], along += bar[c] * t[c];
  if (!(square > 0)) {  // it moves with the surface, and stays with it where friction holds
    if (loss > 0) bar = {};
    return T(0);
  }
  const T speed = sqrt(square), scale = T(1) - loss / speed;
  if (!(scale > 0)) {  // it sticks
    for (int c = 0; c < Dim; ++c) bar[c] = T(0);
    return T(0);
  }
  for (int c = 0; c < Dim; ++c) bar[c] = scale * bar[c] + loss / (square * speed) * along * t[c];
  return -along / speed;
}

/// Adjoint of apply_obstacle: `v` before it, `bar` by the velocity after it, then by the one before. Returns the derivative by the
/// coefficient of friction.
template <class T, int Dim>
JAXMPM_INLINE T obstacle_adjoint(deck::ContactKind kind, T friction, const Vector<T, Dim>& normal, const Vector<T, Dim>& v,
                                 Vector<T, Dim>& bar) {
  using Kind = deck::ContactKind;
  T vn = 0;
  for (int c = 0; c < Dim; ++c) vn += v[c] * normal[c];
  if ((kind == Kind::separate || kind == Kind::friction) && !(vn < 0)) return T(0);
  T by_friction(0), by_vn(0);
  if (kind == Kind::no_slip) bar = {};
  if (kind == Kind::friction) {
    Vector<T, Dim> t;
    for (int c = 0; c < Dim; ++c) t[c] = v[c] - vn * normal[c];
    const T by_loss = rub_adjoint<T, Dim>(t, friction * -vn, bar);
    by_friction = -vn * by_loss, by_vn = -friction * by_loss;
  }
  T along = 0;
  for (int c = 0; c < Dim; ++c) along += bar[c] * normal[c];
  for (int c = 0; c < Dim; ++c) bar[c] += (by_vn - along) * normal[c];
  return by_friction;
}

/// Adjoint of WallUpdate::velocity. `ObstaclesAdjoint` is a callable (Index, velocity before, derivatives&); `Bar` a callable
/// (Index, mass, momentum) that adds derivatives by the NodeSums of a node; `CoefficientBar` one (segment, derivative), `VelocityBar` one
/// (face, component, derivative) for the velocities of the walls.
template <class T, int Dim, class Raw, class Obstacles, class ObstaclesAdjoint, class Bar, class CoefficientBar, class VelocityBar>
class WallAdjoint : WallUpdate<T, Dim, Raw, Obstacles> {
  using Update = WallUpdate<T, Dim, Raw, Obstacles>;
  using typename Update::Mirror;
  using typename Update::Node;
  using typename Update::Seat;
  using typename Update::Sides;
  using typename Update::V;
  const ObstaclesAdjoint& obstacles_adjoint_;
  const Bar& add_;
  const CoefficientBar& add_coefficient_;
  const VelocityBar& add_velocity_;
  bool some_hold_ = false;  // some face holds the material, and so shifts the velocities of images

  /// Adjoint of wall_velocity().
  JAXMPM_FUNCTION void wall_velocity_adjoint(int face, const Node& node, const V& by) const {
    for (int c = 0; c < Dim; ++c)
      if (!this->on_plane(c, node[std::size_t(c)])) add_velocity_(face, c, by[c]);
  }

  /// Adjoint of reflect() at the faces `through` of a node, one after another, as regards the shift. Only walls that hold the material
  /// shift it.
  JAXMPM_FUNCTION void shift_adjoint(const Node& through, const Node& node, V by_shift) const {
    Mirror m = this->no_mirror();
    std::array<std::array<bool, Dim>, Dim> turned{};  // before each
    for (int axis = 0; axis < Dim; ++axis) {
      turned[std::size_t(axis)] = m.turned;
      if (through[std::size_t(axis)] >= 0) this->reflect(through[std::size_t(axis)], node, m);
    }
    for (int axis = Dim - 1; axis >= 0; --axis) {
      const int face = through[std::size_t(axis)];
      if (face < 0) continue;
      V by_u{};
      for (int c = 0; c < Dim; ++c) {
        if (this->sign(face, c) > T(0)) continue;
        if (c != axis) by_u[c] = (turned[std::size_t(axis)][std::size_t(c)] ? T(-2) : T(2)) * by_shift[c];
        by_shift[c] = -by_shift[c];
      }
      wall_velocity_adjoint(face, node, by_u);
    }
  }
  JAXMPM_FUNCTION bool holds(const Node& through) const {
    if (!some_hold_) return false;
    for (const int face : through)
      if (this->sticks(face)) return true;
    return false;
  }
  /// The faces through which the velocity of `asked` is mirrored.
  JAXMPM_FUNCTION Node mirrored_through(const Node& asked) const {
    Node through;
    for (int axis = 0; axis < Dim; ++axis) {
      const int face = this->beyond_faces(axis, asked[std::size_t(axis)]) ? this->face_of(axis, asked[std::size_t(axis)]) : -1;
      through[std::size_t(axis)] = face >= 0 && this->in_contact(face, asked) ? face : -1;
    }
    return through;
  }

  JAXMPM_FUNCTION void fold_adjoint(const Node& node, const std::array<int, Dim>& twin_face, int skip, T by_mass,
                                    const V& by_momentum) const {
    this->for_each_image(node, twin_face, skip, [&](const Node& image, const Mirror& m, const Node& through) {
      V by;
      T by_image_mass = by_mass;
      for (int c = 0; c < Dim; ++c) by[c] = m.sign[c] * by_momentum[c], by_image_mass += m.shift[c] * by_momentum[c];
      add_(image, by_image_mass, by);
      if (!holds(through)) return;
      const T mass = this->raw_(image).mass;
      V by_shift;
      for (int c = 0; c < Dim; ++c) by_shift[c] = mass * by_momentum[c];
      shift_adjoint(through, node, by_shift);
    });
  }

  /// Adjoint of reflected() along a face's normal: `by` is by its value.
  JAXMPM_FUNCTION void reflected_adjoint(int face, const Seat& at, const Sides& s, T by) const {
    if (!(s.mass > this->cut_off_)) return;
    const int axis = face / 2;
    const T value = this->reflected(s, axis), per_mass = by / s.mass;
    V by_twin{}, by_ghost{};
    by_twin[axis] = per_mass * s.ghost.mass, by_ghost[axis] = per_mass * s.twin.mass;
    const T by_twin_mass = per_mass * (s.ghost.momentum[axis] - value), by_ghost_mass = per_mass * (s.twin.momentum[axis] - value);
    fold_adjoint(this->beside(face, at.node, false), at.twin_face, axis, by_twin_mass, by_twin);
    fold_adjoint(this->beside(face, at.node, true), at.twin_face, axis, by_ghost_mass, by_ghost);
  }

  /// Adjoint of apply_faces: `bar` by the velocity after the faces, then by the free velocity; adds to by_mass. `before`[axis]: velocity
  /// before the face of that axis acts.
  JAXMPM_FUNCTION void faces_adjoint(const Seat& at, T mass, const V& free, const std::array<V, Dim>& before, V& bar, T& by_mass) const {
    V by_free{};
    for (int axis = Dim - 1; axis >= 0; --axis) {
      const int face = at.on_face[std::size_t(axis)];
      if (face < 0) continue;
      const auto kind = this->walls_.faces[std::size_t(face)].kind;
      if (kind != deck::ContactKind::friction) continue;
      const Sides s = this->sides(face, at.node, at.twin_face);
      const T normal = this->pressing(face, mass, free, s);
      const int segment = this->walls_.segment(face, at.node);
      const T friction = this->walls_.coefficient[segment], loss = friction * max(T(0), normal) / mass;
      const V u = this->wall_velocity(face, at.node);
      V t;
      for (int c = 0; c < Dim; ++c) t[c] = before[std::size_t(axis)][c] - u[c];
      const T by_normal_velocity = bar[axis];
      t[axis] = T(0), bar[axis] = T(0);
      V by_u = bar;  // u + t: what does not come from t comes from u
      const T by_loss = rub_adjoint<T, Dim>(t, loss, bar);
      for (int c = 0; c < Dim; ++c) by_u[c] -= bar[c];
      wall_velocity_adjoint(face, at.node, by_u);
      bar[axis] = by_normal_velocity;
      by_mass -= by_loss * loss / mass;
      if (!(normal > 0)) continue;
      add_coefficient_(segment, by_loss * normal / mass);
      const T by_normal = -this->inward(face) * by_loss * friction / mass;  // by the bracket in pressing()
      by_mass += by_normal * free[axis], by_free[axis] += by_normal * mass;
      reflected_adjoint(face, at, s, T(2) * by_normal);
    }
    for (int axis = Dim - 1; axis >= 0; --axis) {  // of several that hold, the last has the word
      const int face = at.on_face[std::size_t(axis)];
      if (this->sticks(face)) wall_velocity_adjoint(face, at.node, bar), bar = {};
    }
    for (int axis = 0; axis < Dim; ++axis)
      if (at.on_face[std::size_t(axis)] >= 0) bar[axis] = T(0);
    for (int c = 0; c < Dim; ++c) bar[c] += by_free[c];
  }

  /// The faces once more, keeping the velocity before each.
  JAXMPM_FUNCTION std::array<V, Dim> apply_faces(const Seat& at, T mass, const V& free, V& v) const {
    std::array<V, Dim> before;
    this->hold(at, v);
    for (int axis = 0; axis < Dim; ++axis) {
      before[std::size_t(axis)] = v;
      const int face = at.on_face[std::size_t(axis)];
      if (face >= 0) this->apply_face(face, at, mass, free, v, nullptr);
    }
    return before;
  }

 public:
  JAXMPM_FUNCTION WallAdjoint(const Walls<T, Dim>& walls, const Raw& raw, const Obstacles& obstacles, T cut_off,
                              const ObstaclesAdjoint& obstacles_adjoint, const Bar& add, const CoefficientBar& add_coefficient,
                              const VelocityBar& add_velocity)
      : Update(walls, raw, obstacles, cut_off),
        obstacles_adjoint_(obstacles_adjoint),
        add_(add),
        add_coefficient_(add_coefficient),
        add_velocity_(add_velocity) {
    for (int face = 0; face < 2 * Dim; ++face) some_hold_ = some_hold_ || this->sticks(face);
  }

  /// Passes the derivatives by the velocity of a node on to the sums that it came from.
  JAXMPM_FUNCTION void velocity(const Node& asked, V bar) const {
    const Seat at = this->seat(asked);
    const NodeSums<T, Dim> sum = this->folded(at.node, at.twin_face, -1);
    if (!(sum.mass > this->cut_off_)) return;
    V free;
    for (int c = 0; c < Dim; ++c) free[c] = sum.momentum[c] / sum.mass;
    V v = free;
    const std::array<V, Dim> before = apply_faces(at, sum.mass, free, v);
    if (some_hold_)
      if (const Node through = mirrored_through(asked); holds(through)) shift_adjoint(through, asked, bar);
    for (int c = 0; c < Dim; ++c) bar[c] *= at.mirror.sign[c];
    if (this->inside(at.node)) obstacles_adjoint_(at.node, v, bar);
    T by_mass(0);
    faces_adjoint(at, sum.mass, free, before, bar, by_mass);
    for (int c = 0; c < Dim; ++c) by_mass -= bar[c] * free[c] / sum.mass, bar[c] /= sum.mass;
    fold_adjoint(at.node, at.twin_face, -1, by_mass, bar);
  }
};

}  // namespace jaxmpm
