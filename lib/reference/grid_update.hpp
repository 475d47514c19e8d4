#pragma once
// Walls, obstacles and the node velocities of the reference step: the section "Grid update" of docs/theory.md, one function per rule.
#include <optional>

#include "reference/step.hpp"

namespace jaxmpm {

template <class Scalar>
class ReferenceGridUpdate {
 public:
  /// Masses not above the cut-off count as none.
  ReferenceGridUpdate(const Model& model, const Scalar& mass_cutoff, ReferenceReport<Scalar>& report)
      : model_(model), mass_cutoff_(mass_cutoff), report_(report) {}

  /// From predicted momenta to velocities and their changes, at every node of the report's grid; adds up impulses and friction.
  void run();

 private:
  /// A raw node that is folded onto an inner one: where it is, and the sign of each component of what it brings.
  struct Image {
    Node node;
    Triple<double> sign{1, 1, 1}, shift{};  // v' = sign ∘ v + shift
    std::array<bool, 3> turned{};           // along which axes a face has turned the normal component
  };
  /// The image of an image of `node` at a face; what a turned normal component carries of other walls' velocities turns with it.
  void reflect(int face, const Node& node, Image& image) const;

  int last(int axis) const { return model_.cells[axis]; }
  static int face_axis(int face) { return face / 2; }
  /// Component of the normal along the face's axis: from the solid into the material.
  static double normal(int face) { return face % 2 == 0 ? 1 : -1; }
  int plane(int face) const { return face % 2 == 0 ? 0 : last(face_axis(face)); }
  int twin(int face) const { return face % 2 == 0 ? 1 : last(face_axis(face)) - 1; }
  int ghost(int face) const { return face % 2 == 0 ? -1 : last(face_axis(face)) + 1; }

  Scalar mass(const Node& node) const;
  Scalar predicted(const Node& node, int component) const;
  /// Whether the face touches the material on the lattice line through this node along the face's normal.
  bool in_contact(int face, const Node& node) const;
  double mirror_sign(int face, int component) const;
  Image representative(const Node& node) const;
  /// The node itself and its ghosts, over all subsets of the axes with contact; `skip` leaves an axis out (−1: none).
  std::vector<Image> images(const Node& inner, int skip) const;

  /// Nothing where there is no mass.
  std::optional<Triple<Scalar>> inner_velocity(const Node& inner);
  bool on_face_in_contact(int face, const Node& inner) const { return inner[face_axis(face)] == plane(face) && in_contact(face, inner); }
  /// Velocity of a face at a node: not against other faces that the node lies on.
  Triple<double> wall_velocity(int face, const Node& inner) const;
  void apply_normals(const Node& inner, Triple<Scalar>& v) const;
  void apply_friction(const Node& inner, const Scalar& folded_mass, const std::vector<Image>& folded, Triple<Scalar>& v);
  void apply_obstacles(const Node& inner, const Scalar& folded_mass, const std::vector<Image>& folded, Triple<Scalar>& v);
  void push_off(const RigidObstacle& obstacle, const Point& normal, const Scalar& mass, Triple<Scalar>& v);
  Scalar normal_impulse(int face, const Node& inner) const;
  double friction_coefficient(int face, const Node& inner) const;
  bool is_inside(const Node& node) const;
  /// The face that the first stage's impulse along a component belongs to, −1 where none acts.
  int responsible_face(const Node& inner, int component) const;
  /// Adds Σ m_i (v_after − v_before) over a node and its images.
  void add_impulse(Triple<Scalar>& to, const std::vector<Image>& folded, const Triple<Scalar>& before, const Triple<Scalar>& after) const;

  const Model& model_;
  Scalar mass_cutoff_;
  ReferenceReport<Scalar>& report_;
};

}  // namespace jaxmpm
