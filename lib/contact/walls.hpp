#pragma once
// Domain faces on the grid: the mirror images beyond a wall, folded onto their twins (docs/theory.md, "Grid update").
#include <algorithm>
#include <array>
#include <vector>

#include "core/scalar.hpp"
#include "core/tensor.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

/// Faces of the domain in the precision of the step: a plain view that kernels copy, on the segments of a WallTable.
template <class T, int Dim>
struct Walls {
  struct Face {
    deck::ContactKind kind;
    int first, count;  // its segments
    int segment_axis;
    Vector<T, Dim> velocity;  // along itself, m/s
    JAXMPM_FUNCTION bool always() const { return kind == deck::ContactKind::slip || kind == deck::ContactKind::no_slip; }
  };
  std::array<int, Dim> cells;
  std::array<Face, 2 * Dim> faces;
  const double* to;      // ends of all segments, cells
  const T* coefficient;  // one per segment

  /// Segment of a face with friction at a node: the first with X ≤ to, behind the last the last.
  JAXMPM_FUNCTION int segment(int face, const std::array<int, Dim>& node) const {
    const Face& f = faces[std::size_t(face)];
    int k = f.first;
    for (const int last = f.first + f.count - 1; k < last && !(node[std::size_t(f.segment_axis)] <= to[k]); ++k) {
    }
    return k;
  }
  JAXMPM_FUNCTION bool periodic(int axis) const { return faces[std::size_t(2 * axis)].kind == deck::ContactKind::periodic; }
  JAXMPM_FUNCTION bool open(int face) const { return faces[std::size_t(face)].kind == deck::ContactKind::open; }
  JAXMPM_FUNCTION T friction(int face, const std::array<int, Dim>& node) const { return coefficient[segment(face, node)]; }
  /// Whether a node is a ghost, a twin or on a face along some axis: everywhere else the update is plain division.
  JAXMPM_FUNCTION bool near_face(int axis, int node) const {
    return !periodic(axis) && (node <= 1 || node >= cells[std::size_t(axis)] - 1);
  }
  JAXMPM_FUNCTION bool near_face(const std::array<int, Dim>& node) const {
    for (int d = 0; d < Dim; ++d)
      if (near_face(d, node[std::size_t(d)])) return true;
    return false;
  }
};

/// The segments of all faces of a model.
template <class T, int Dim>
struct WallTable {
  std::vector<double> to;  // of a face without segments: 0, never asked
  std::vector<T> coefficient;
  std::array<int, Dim> cells;
  std::array<typename Walls<T, Dim>::Face, 2 * Dim> faces;

  explicit WallTable(const Model& model) {
    for (int d = 0; d < Dim; ++d) cells[std::size_t(d)] = model.cells[std::size_t(d)];
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const FaceLaw& law = model.faces[f];
      faces[f] = {law.kind, int(to.size()), int(law.coefficient.size()), law.segment_axis, {}};
      for (int c = 0; c < Dim; ++c) faces[f].velocity[c] = T(law.velocity[std::size_t(c)]);
      coefficient.insert(coefficient.end(), law.coefficient.begin(), law.coefficient.end());
      to.insert(to.end(), law.to.begin(), law.to.begin() + std::ptrdiff_t(std::min(law.to.size(), law.coefficient.size())));
      to.resize(coefficient.size());
    }
  }
  /// The view for kernels; the arrays are this table's, or copies of them in another memory.
  Walls<T, Dim> view() const { return view(to.data(), coefficient.data()); }
  Walls<T, Dim> view(const double* ends, const T* values) const { return {cells, faces, ends, values}; }
};

/// Mass and predicted momentum P of a node before any wall acts.
template <class T, int Dim>
struct NodeSums {
  T mass;
  Vector<T, Dim> momentum;
};

/// What contact did at one node: impulse given to the material, N s, and energy lost to friction, J.
template <class T, int Dim>
struct NodeContact {
  std::array<std::array<T, Dim>, 2 * Dim> impulse{};
  T friction_work = 0;
};

/// Velocity of any node in the mirrored domain. `Raw` is a callable Index → NodeSums (zero mass where there is nothing); `Obstacles` a
/// callable (Index, mass, velocity&) that applies the rigid obstacles at an inner node.
template <class T, int Dim, class Raw, class Obstacles>
class WallUpdate {
 protected:
  using Node = std::array<int, Dim>;
  using V = Vector<T, Dim>;
  const Walls<T, Dim>& walls_;
  const Raw& raw_;
  const Obstacles& obstacles_;
  T cut_off_;

  JAXMPM_FUNCTION int n(int axis) const { return walls_.cells[std::size_t(axis)]; }
  JAXMPM_FUNCTION bool beyond_faces(int axis, int i) const { return !walls_.periodic(axis) && (i < 0 || i > n(axis)); }
  JAXMPM_FUNCTION int reflect(int axis, int i) const { return !beyond_faces(axis, i) ? i : (i < 0 ? -i : 2 * n(axis) - i); }
  /// Face that a ghost, face or twin node belongs to along an axis, −1 for none.
  JAXMPM_FUNCTION int face_of(int axis, int i) const {
    if (walls_.periodic(axis)) return -1;
    return i <= 1 && i >= -1 ? 2 * axis : (i >= n(axis) - 1 && i <= n(axis) + 1 ? 2 * axis + 1 : -1);
  }
  JAXMPM_FUNCTION int plane(int face) const { return face % 2 == 0 ? 0 : n(face / 2); }
  JAXMPM_FUNCTION T inward(int face) const { return face % 2 == 0 ? T(1) : T(-1); }
  JAXMPM_FUNCTION T sign(int face, int component) const {
    return component == face / 2 || walls_.faces[std::size_t(face)].kind == deck::ContactKind::no_slip ? T(-1) : T(1);
  }
  JAXMPM_FUNCTION bool on_plane(int axis, int i) const {
    return !walls_.periodic(axis) && ((i == 0 && !walls_.open(2 * axis)) || (i == n(axis) && !walls_.open(2 * axis + 1)));
  }
  /// Velocity of a face at a node, without what would push the material through another face that the node lies on.
  JAXMPM_FUNCTION V wall_velocity(int face, const Node& node) const {
    V u{};
    for (int c = 0; c < Dim; ++c)
      if (!on_plane(c, node[std::size_t(c)])) u[c] = walls_.faces[std::size_t(face)].velocity[c];
    return u;
  }
  /// Velocities of images: v' = sign ∘ v + shift. `turned`: along which axes a face has turned the normal component.
  struct Mirror {
    V sign, shift;
    std::array<bool, Dim> turned;
  };
  static JAXMPM_FUNCTION Mirror no_mirror() {
    Mirror m{};
    for (int c = 0; c < Dim; ++c) m.sign[c] = T(1);
    return m;
  }
  /// The mirror image at a face of what a mirror gives: where the sign turns, the velocity relative to the wall does. The order of faces is
  /// of no account: a normal component that turns takes the other walls' velocities with it.
  JAXMPM_FUNCTION void reflect(int face, const Node& node, Mirror& m) const {
    const V u = wall_velocity(face, node);
    for (int c = 0; c < Dim; ++c) {
      if (sign(face, c) > T(0)) continue;
      const bool normal = c == face / 2;
      const T twice = normal ? T(0) : T(2) * u[c];
      m.sign[c] = -m.sign[c], m.shift[c] = (m.turned[std::size_t(c)] ? -twice : twice) - m.shift[c];
      m.turned[std::size_t(c)] = m.turned[std::size_t(c)] || normal;
    }
  }

  JAXMPM_FUNCTION bool inside(const Node& node) const {
    for (int d = 0; d < Dim; ++d)
      if (beyond_faces(d, node[std::size_t(d)])) return false;
    return true;
  }

  /// Whether the material presses on a face along the lattice line through `node`.
  JAXMPM_FUNCTION bool in_contact(int face, Node node) const {
    if (walls_.faces[std::size_t(face)].always()) return true;
    if (walls_.open(face)) return false;
    for (int d = 0; d < Dim; ++d) node[std::size_t(d)] = d == face / 2 ? plane(face) : reflect(d, node[std::size_t(d)]);
    const NodeSums<T, Dim> f = raw_(node);
    return f.mass > cut_off_ && f.momentum[face / 2] * inward(face) < 0;
  }

  /// A node with regard to the faces in contact: the inner node whose image it is (itself where it is none), the mirror that its velocity
  /// goes through, and per axis the face that the inner node lies on, or whose ghost is its twin (−1 for none).
  struct Seat {
    Node node;
    Mirror mirror;
    std::array<int, Dim> on_face, twin_face;
  };
  JAXMPM_FUNCTION Seat seat(const Node& asked) const {
    Seat s;
    s.node = asked;
    s.mirror = no_mirror();
    for (int axis = 0; axis < Dim; ++axis) {
      const auto a = std::size_t(axis);
      s.on_face[a] = s.twin_face[a] = -1;
      const int face = face_of(axis, asked[a]);
      if (face < 0 || !in_contact(face, asked)) continue;
      if (beyond_faces(axis, asked[a])) s.node[a] = reflect(axis, asked[a]), reflect(face, asked, s.mirror);
      if (s.node[a] == plane(face)) s.on_face[a] = face;
      else s.twin_face[a] = face;
    }
    return s;
  }

  static JAXMPM_FUNCTION bool is_image(const Seat& s, const Node& asked) {
    for (std::size_t d = 0; d < Dim; ++d)
      if (s.node[d] != asked[d]) return true;
    return false;
  }

  /// Calls f(image, mirror, through) for a node and those of its images that `folded` adds to it. `through`: the faces that mirror it, per
  /// axis (−1 for none).
  template <class F>
  JAXMPM_FUNCTION void for_each_image(const Node& node, const std::array<int, Dim>& twin_face, int skip, F f) const {
    for (int subset = 0; subset < (1 << Dim); ++subset) {
      Node image = node, through;
      Mirror mirror = no_mirror();
      bool valid = true;
      for (int axis = 0; axis < Dim && valid; ++axis) {
        through[std::size_t(axis)] = -1;
        if (!(subset >> axis & 1)) continue;
        const int face = through[std::size_t(axis)] = twin_face[std::size_t(axis)];
        valid = axis != skip && face >= 0;
        if (!valid) break;
        image[std::size_t(axis)] = 2 * plane(face) - node[std::size_t(axis)];
        reflect(face, node, mirror);
      }
      if (valid) f(image, mirror, through);
    }
  }
  /// Sums of a node with the twins along the axes of `twin_face` (face per axis or −1) folded onto it, axis `skip` left out.
  JAXMPM_FUNCTION NodeSums<T, Dim> folded(const Node& node, const std::array<int, Dim>& twin_face, int skip) const {
    NodeSums<T, Dim> sum{};
    for_each_image(node, twin_face, skip, [&](const Node& image, const Mirror& m, const Node&) {
      const NodeSums<T, Dim> other = raw_(image);
      sum.mass += other.mass;
      for (int c = 0; c < Dim; ++c) sum.momentum[c] += m.sign[c] * other.momentum[c] + m.shift[c] * other.mass;
    });
    return sum;
  }
  /// The node beside a face node on the inner (twin) or the outer side (ghost).
  JAXMPM_FUNCTION Node beside(int face, Node node, bool outside) const {
    node[std::size_t(face / 2)] += (face % 2 == 0) == outside ? -1 : 1;
    return node;
  }
  /// Sums on both sides of a face node.
  struct Sides {
    NodeSums<T, Dim> twin, ghost;
    T mass;  // of both
  };
  JAXMPM_FUNCTION Sides sides(int face, const Node& node, const std::array<int, Dim>& twin_face) const {
    Sides s{folded(beside(face, node, false), twin_face, face / 2), folded(beside(face, node, true), twin_face, face / 2), T(0)};
    s.mass = s.twin.mass + s.ghost.mass;
    return s;
  }
  /// Half of the momentum along c that the mirror takes from twin and ghost: P_g + m_g v of the twin's velocity v = (P_t − P_g)/(m_t +
  /// m_g).
  JAXMPM_FUNCTION T reflected(const Sides& s, int c) const {
    return s.mass > cut_off_ ? (s.twin.mass * s.ghost.momentum[c] + s.ghost.mass * s.twin.momentum[c]) / s.mass : T(0);
  }
  /// Normal impulse between the material and a face, positive where it presses: the face node's and what its neighbours' mirror takes.
  JAXMPM_FUNCTION T pressing(int face, T mass, const V& free, const Sides& s) const {
    return -inward(face) * (mass * free[face / 2] + T(2) * reflected(s, face / 2));
  }
  /// What remains of a velocity tangential to a face of size `speed` when friction takes `loss` (m/s) off it, to rest at most.
  static JAXMPM_FUNCTION T remaining(T loss, T speed) { return max(T(0), T(1) - loss / speed); }
  JAXMPM_FUNCTION bool sticks(int face) const { return face >= 0 && walls_.faces[std::size_t(face)].kind == deck::ContactKind::no_slip; }

 public:
  JAXMPM_FUNCTION WallUpdate(const Walls<T, Dim>& walls, const Raw& raw, const Obstacles& obstacles, T cut_off)
      : walls_(walls), raw_(raw), obstacles_(obstacles), cut_off_(cut_off) {}

  /// Velocity after walls and obstacles. `contact` (may be null) receives what happened at the node and its images; nothing where the node
  /// is itself an image.
  JAXMPM_FUNCTION V velocity(const Node& asked, NodeContact<T, Dim>* contact) const {
    const Seat at = seat(asked);
    const NodeSums<T, Dim> sum = folded(at.node, at.twin_face, -1);
    V v;
    for (int c = 0; c < Dim; ++c) v[c] = T(0);
    if (!(sum.mass > cut_off_)) return v;
    for (int c = 0; c < Dim; ++c) v[c] = sum.momentum[c] / sum.mass;
    apply_faces(at, sum.mass, v, is_image(at, asked) ? nullptr : contact);
    if (inside(at.node)) obstacles_(at.node, sum.mass, v);
    for (int c = 0; c < Dim; ++c) v[c] = at.mirror.sign[c] * v[c] + at.mirror.shift[c];
    return v;
  }

 protected:
  /// What faces do before friction: v·n = 0 on all of them, and the wall's velocity on those where the material sticks.
  JAXMPM_FUNCTION void hold(const Seat& at, V& v) const {
    for (int axis = 0; axis < Dim; ++axis)
      if (at.on_face[std::size_t(axis)] >= 0) v[axis] = T(0);
    for (int axis = 0; axis < Dim; ++axis)
      if (sticks(at.on_face[std::size_t(axis)])) v = wall_velocity(at.on_face[std::size_t(axis)], at.node);
  }
  JAXMPM_FUNCTION void apply_faces(const Seat& at, T mass, V& v, NodeContact<T, Dim>* contact) const {
    const V free = v;
    hold(at, v);
    if (contact) report_held(at, v, *contact);
    for (int axis = 0; axis < Dim; ++axis)
      if (at.on_face[std::size_t(axis)] >= 0) apply_face(at.on_face[std::size_t(axis)], at, mass, free, v, contact);
  }
  /// Friction of a face at the node on it, and its report.
  JAXMPM_FUNCTION void apply_face(int face, const Seat& at, T mass, const V& free, V& v, NodeContact<T, Dim>* contact) const {
    if (walls_.faces[std::size_t(face)].kind != deck::ContactKind::friction) return;
    const T normal = pressing(face, mass, free, sides(face, at.node, at.twin_face));
    const V before = v;
    rub(face / 2, walls_.friction(face, at.node) * max(T(0), normal) / mass, mass, wall_velocity(face, at.node), v, contact);
    if (contact) report_rubbed(face, at, before, v, *contact);
  }

 private:
  /// Takes `loss` (m/s) off the velocity tangential to a face that moves with `u`, until both move together at most.
  JAXMPM_FUNCTION void rub(int axis, T loss, T mass, const V& u, V& v, NodeContact<T, Dim>* contact) const {
    T square = 0;
    for (int c = 0; c < Dim; ++c)
      if (c != axis) square += (v[c] - u[c]) * (v[c] - u[c]);
    if (!(square > 0)) return;
    const T scale = remaining(loss, sqrt(square));
    for (int c = 0; c < Dim; ++c)
      if (c != axis) v[c] = u[c] + scale * (v[c] - u[c]);
    if (contact) contact->friction_work += T(0.5) * mass * square * (T(1) - scale * scale);
  }
  /// The face whose mirror decides a component of a node's velocity: that across it, else the first that holds it; −1 for none.
  JAXMPM_FUNCTION int responsible_face(const Seat& at, int c) const {
    int found = -1;
    for (int axis = 0; axis < Dim; ++axis) {
      const int face = at.on_face[std::size_t(axis)] >= 0 ? at.on_face[std::size_t(axis)] : at.twin_face[std::size_t(axis)];
      if (face < 0 || sign(face, c) > T(0)) continue;
      if (axis == c) return face;
      if (found < 0) found = face;
    }
    return found;
  }
  /// What the mirror gives a node and its images: their momentum with the velocity `v`, less that from before.
  JAXMPM_FUNCTION void report_held(const Seat& at, const V& v, NodeContact<T, Dim>& contact) const {
    for_each_image(at.node, at.twin_face, -1, [&](const Node& image, const Mirror& m, const Node&) {
      const NodeSums<T, Dim> sum = raw_(image);
      for (int c = 0; c < Dim; ++c)
        if (const int face = responsible_face(at, c); face >= 0)
          contact.impulse[std::size_t(face)][std::size_t(c)] += sum.mass * (m.sign[c] * v[c] + m.shift[c]) - sum.momentum[c];
    });
  }
  /// What friction of a face gives them.
  JAXMPM_FUNCTION void report_rubbed(int face, const Seat& at, const V& before, const V& after, NodeContact<T, Dim>& contact) const {
    for_each_image(at.node, at.twin_face, -1, [&](const Node& image, const Mirror& m, const Node&) {
      const T mass = raw_(image).mass;
      for (int c = 0; c < Dim; ++c) contact.impulse[std::size_t(face)][std::size_t(c)] += mass * m.sign[c] * (after[c] - before[c]);
    });
  }
};

}  // namespace jaxmpm
