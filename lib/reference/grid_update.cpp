#include "reference/grid_update.hpp"

#include "scene/holding_normals.hpp"

namespace jaxmpm {
namespace {

template <class Scalar>
Scalar length(const Triple<Scalar>& v) {
  const Scalar square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  return square > Scalar(0) ? sqrt(square) : Scalar(0);
}

/// 1 − μN/(M|v_t|), not below 0 (Bardenhagen's Coulomb limit; Du & He 2025, Eq 36): what is left of a tangential velocity.
template <class Scalar>
Scalar friction_scale(const Scalar& limit, const Scalar& speed) {
  return speed > limit ? Scalar(1) - limit / speed : Scalar(0);
}

}  // namespace

template <class Scalar>
Scalar ReferenceGridUpdate<Scalar>::mass(const Node& node) const {
  const auto found = report_.grid.find(node);
  return found == report_.grid.end() ? Scalar(0) : found->second.mass;
}

template <class Scalar>
Scalar ReferenceGridUpdate<Scalar>::predicted(const Node& node, int component) const {
  const auto found = report_.grid.find(node);
  return found == report_.grid.end() ? Scalar(0) : found->second.predicted[component];
}

template <class Scalar>
bool ReferenceGridUpdate<Scalar>::is_inside(const Node& node) const {
  for (int a = 0; a < model_.dim; ++a)
    if (!model_.is_periodic(a) && (node[a] < 0 || node[a] > last(a))) return false;
  return true;
}

template <class Scalar>
bool ReferenceGridUpdate<Scalar>::in_contact(int face, const Node& node) const {
  const deck::ContactKind kind = model_.faces[face].kind;
  if (kind == deck::ContactKind::periodic || kind == deck::ContactKind::open) return false;
  if (kind == deck::ContactKind::slip || kind == deck::ContactKind::no_slip) return true;
  Node at = node;
  for (int a = 0; a < model_.dim; ++a) at[a] = at[a] < 0 ? -at[a] : at[a] > last(a) ? 2 * last(a) - at[a] : at[a];
  at[face_axis(face)] = plane(face);
  return mass(at) > mass_cutoff_ && predicted(at, face_axis(face)) * Scalar(normal(face)) < Scalar(0);
}

template <class Scalar>
double ReferenceGridUpdate<Scalar>::mirror_sign(int face, int component) const {
  return component == face_axis(face) || model_.faces[face].kind == deck::ContactKind::no_slip ? -1 : 1;
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::reflect(int face, const Node& node, Image& image) const {
  const Triple<double> u = wall_velocity(face, node);
  for (int c = 0; c < model_.dim; ++c) {
    if (mirror_sign(face, c) > 0) continue;
    image.sign[c] = -image.sign[c];
    if (c == face_axis(face)) image.shift[c] = -image.shift[c], image.turned[c] = true;
    else image.shift[c] = (image.turned[c] ? -2 : 2) * u[c] - image.shift[c];
  }
}

template <class Scalar>
typename ReferenceGridUpdate<Scalar>::Image ReferenceGridUpdate<Scalar>::representative(const Node& node) const {
  Image image{node};
  for (int face = 0; face < 2 * model_.dim; ++face) {
    if (node[face_axis(face)] != ghost(face) || !in_contact(face, node)) continue;
    image.node[face_axis(face)] = twin(face);
    reflect(face, node, image);
  }
  return image;
}

template <class Scalar>
std::vector<typename ReferenceGridUpdate<Scalar>::Image> ReferenceGridUpdate<Scalar>::images(const Node& inner, int skip) const {
  std::vector<Image> all{Image{inner}};
  for (int face = 0; face < 2 * model_.dim; ++face) {
    const int axis = face_axis(face);
    if (axis == skip || inner[axis] != twin(face) || !in_contact(face, inner)) continue;
    const std::vector<Image> so_far = all;
    for (Image image : so_far) {
      if (image.node[axis] != inner[axis]) continue;  // already the ghost of the opposite face: two cells between the faces
      image.node[axis] = ghost(face);
      reflect(face, inner, image);
      all.push_back(image);
    }
  }
  return all;
}

template <class Scalar>
Triple<double> ReferenceGridUpdate<Scalar>::wall_velocity(int face, const Node& inner) const {
  Triple<double> u = model_.faces[face].velocity;
  for (int a = 0; a < model_.dim; ++a)
    if (!model_.is_periodic(a) && ((inner[a] == 0 && !model_.is_open(a, false)) || (inner[a] == last(a) && !model_.is_open(a, true))))
      u[a] = 0;
  return u;
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::apply_normals(const Node& inner, Triple<Scalar>& v) const {
  for (int face = 0; face < 2 * model_.dim; ++face) {
    if (!on_face_in_contact(face, inner)) continue;
    const Triple<double> u = wall_velocity(face, inner);
    for (int c = 0; c < model_.dim; ++c)
      if (mirror_sign(face, c) < 0) v[c] = Scalar(u[c]);
  }
}

template <class Scalar>
Scalar ReferenceGridUpdate<Scalar>::normal_impulse(int face, const Node& inner) const {
  const int axis = face_axis(face);
  Scalar own(0), twin_mass(0), twin_momentum(0), ghost_mass(0), ghost_momentum(0);
  const auto folded = [&](const Image& image, const Node& node) {
    return Scalar(image.sign[axis]) * predicted(node, axis) + Scalar(image.shift[axis]) * mass(node);
  };
  for (const Image& image : images(inner, axis)) {
    Node inside = image.node, outside = image.node;
    inside[axis] = twin(face), outside[axis] = ghost(face);
    own += folded(image, image.node);
    twin_mass += mass(inside), ghost_mass += mass(outside);
    twin_momentum += folded(image, inside), ghost_momentum += folded(image, outside);
  }
  // With the twin's velocity v = (P_t − P_g)/(m_t + m_g), the mirror takes −2 (P_g + m_g v) from both.
  const Scalar both = twin_mass + ghost_mass;
  if (both > mass_cutoff_) own += Scalar(2) * (ghost_momentum + ghost_mass * (twin_momentum - ghost_momentum) / both);
  return max(-Scalar(normal(face)) * own, Scalar(0));
}

template <class Scalar>
double ReferenceGridUpdate<Scalar>::friction_coefficient(int face, const Node& inner) const {
  const FaceLaw& law = model_.faces[face];
  for (std::size_t k = 0; k < law.to.size(); ++k)
    if (inner[law.segment_axis] <= law.to[k]) return law.coefficient[k];
  return law.coefficient.back();
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::apply_friction(const Node& inner, const Scalar& folded_mass, const std::vector<Image>& folded,
                                                 Triple<Scalar>& v) {
  for (int face = 0; face < 2 * model_.dim; ++face) {
    const int axis = face_axis(face);
    if (model_.faces[face].kind != deck::ContactKind::friction || inner[axis] != plane(face) || !in_contact(face, inner)) continue;
    const Triple<double> u = wall_velocity(face, inner);
    Triple<Scalar> tangential{};
    for (int c = 0; c < model_.dim; ++c)
      if (c != axis) tangential[c] = v[c] - Scalar(u[c]);
    const Scalar limit = Scalar(friction_coefficient(face, inner)) * normal_impulse(face, inner) / folded_mass;
    const Scalar speed = length(tangential);
    const Scalar scale = friction_scale(limit, speed);
    const Triple<Scalar> before = v;
    for (int c = 0; c < model_.dim; ++c)
      if (c != axis) v[c] = Scalar(u[c]) + scale * tangential[c];
    add_impulse(report_.face_impulse[face], folded, before, v);
    report_.friction += Scalar(0.5) * folded_mass * speed * speed * (Scalar(1) - scale * scale);
  }
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::apply_obstacles(const Node& inner, const Scalar& folded_mass, const std::vector<Image>& folded,
                                                  Triple<Scalar>& v) {
  if (!is_inside(inner)) return;
  const Point at{double(inner[0]), double(inner[1]), double(inner[2])};
  for (std::size_t o = 0; o < model_.obstacles.size(); ++o)
    for (const Point& normal : holding_normals(model_.obstacles[o], at, model_)) {
      const Triple<Scalar> before = v;
      push_off(model_.obstacles[o], normal, folded_mass, v);
      add_impulse(report_.obstacle_impulse[o], folded, before, v);
    }
}

/// Contact with one surface of an obstacle (Eqs 33, 35, 36).
template <class Scalar>
void ReferenceGridUpdate<Scalar>::push_off(const RigidObstacle& obstacle, const Point& normal, const Scalar& mass, Triple<Scalar>& v) {
  Scalar approach(0);
  for (int c = 0; c < model_.dim; ++c) approach += v[c] * Scalar(normal[c]);
  const bool bilateral = obstacle.kind == deck::ContactKind::slip || obstacle.kind == deck::ContactKind::no_slip;
  if (!bilateral && !(approach < Scalar(0))) return;
  for (int c = 0; c < model_.dim; ++c) v[c] -= approach * Scalar(normal[c]);
  if (obstacle.kind == deck::ContactKind::no_slip) v = {};
  if (obstacle.kind != deck::ContactKind::friction) return;
  const Scalar speed = length(v);
  const Scalar scale = friction_scale(Scalar(obstacle.coefficient) * abs(approach), speed);
  for (int c = 0; c < model_.dim; ++c) v[c] = scale * v[c];
  report_.friction += Scalar(0.5) * mass * speed * speed * (Scalar(1) - scale * scale);
}

template <class Scalar>
int ReferenceGridUpdate<Scalar>::responsible_face(const Node& inner, int component) const {
  int found = -1;
  for (int face = 0; face < 2 * model_.dim; ++face) {
    const int axis = face_axis(face);
    const bool near = inner[axis] == plane(face) || inner[axis] == twin(face);
    if (!near || mirror_sign(face, component) > 0 || !in_contact(face, inner)) continue;
    if (axis == component) return face;
    if (found < 0) found = face;
  }
  return found;
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::add_impulse(Triple<Scalar>& to, const std::vector<Image>& folded, const Triple<Scalar>& before,
                                              const Triple<Scalar>& after) const {
  for (const Image& image : folded)
    for (int c = 0; c < model_.dim; ++c) to[c] += mass(image.node) * Scalar(image.sign[c]) * (after[c] - before[c]);
}

template <class Scalar>
std::optional<Triple<Scalar>> ReferenceGridUpdate<Scalar>::inner_velocity(const Node& inner) {
  const std::vector<Image> folded = images(inner, -1);
  Scalar M(0);
  Triple<Scalar> P{}, v{};
  for (const Image& image : folded) {
    M += mass(image.node);
    for (int c = 0; c < model_.dim; ++c)
      P[c] += Scalar(image.sign[c]) * predicted(image.node, c) + Scalar(image.shift[c]) * mass(image.node);
  }
  if (!(M > mass_cutoff_)) return std::nullopt;
  for (int c = 0; c < model_.dim; ++c) v[c] = P[c] / M;
  apply_normals(inner, v);
  for (int c = 0; c < model_.dim; ++c) {
    const int face = responsible_face(inner, c);
    if (face < 0) continue;
    for (const Image& image : folded)
      report_.face_impulse[face][c] +=
          mass(image.node) * (Scalar(image.sign[c]) * v[c] + Scalar(image.shift[c])) - predicted(image.node, c);
  }
  apply_friction(inner, M, folded, v);
  apply_obstacles(inner, M, folded, v);
  return v;
}

template <class Scalar>
void ReferenceGridUpdate<Scalar>::run() {
  std::map<Node, std::optional<Triple<Scalar>>> inner;
  for (auto& [node, values] : report_.grid) {
    const Image image = representative(node);
    auto found = inner.find(image.node);
    if (found == inner.end()) found = inner.emplace(image.node, inner_velocity(image.node)).first;
    for (int c = 0; found->second && c < model_.dim; ++c) {
      values.velocity[c] = Scalar(image.sign[c]) * (*found->second)[c] + Scalar(image.shift[c]);
      if (values.mass > mass_cutoff_) values.change[c] = values.velocity[c] - values.momentum[c] / values.mass;
    }
  }
}

template class ReferenceGridUpdate<double>;
template class ReferenceGridUpdate<ReferenceDual>;

}  // namespace jaxmpm
