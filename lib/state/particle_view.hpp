#pragma once
// What the transfers see of one body's particles: where each field lies, be it in the body's own arrays, among the numbers of a kept state or
// in memory for one tile.
#include <array>

#include "state/particles.hpp"

namespace jaxmpm {

/// A field: data()[a] is particle a's.
template <class T>
class FieldView {
 public:
  using Value = T;
  FieldView() = default;
  explicit FieldView(T* first) : first_(first) {}
  T* data() { return first_; }
  const T* data() const { return first_; }

 private:
  T* first_ = nullptr;
};

/// Up to `most` fields of one kind.
template <class T, int most>
class FieldViews {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  FieldView<T>& operator[](std::size_t k) { return fields_[k]; }
  const FieldView<T>& operator[](std::size_t k) const { return fields_[k]; }
  FieldView<T>* begin() { return fields_.data(); }
  FieldView<T>* end() { return fields_.data() + size_; }
  void add(T* first) { fields_[size_++] = FieldView<T>(first); }

 private:
  std::array<FieldView<T>, std::size_t(most)> fields_;
  std::size_t size_ = 0;
};

/// As Particles. What a const view shows is only read.
template <class T, int Dim>
struct ParticleView {
  static constexpr int most_history = 12;
  FieldViews<double, Dim> position;
  FieldViews<T, Dim> velocity;
  FieldView<T> mass, compression;
  FieldViews<T, Dim * Dim> affine;
  FieldViews<T, most_history> history;
  FieldViews<T, 1> dilation;
  FieldViews<T, Dim * Dim> gradient;

  ParticleView(Particles<T, Dim>& p) : mass(p.mass.data()), compression(p.compression.data()) {
    add(p.position, position), add(p.velocity, velocity), add(p.affine, affine), add(p.history, history);
    add(p.dilation, dilation), add(p.gradient, gradient);
  }
  /// For functions that take a const view.
  ParticleView(const Particles<T, Dim>& p) : ParticleView(const_cast<Particles<T, Dim>&>(p)) {}

  /// See Particles; f(field view).
  template <class F>
  void for_each_material_field(F&& f) {
    visit_material_fields(*this, f);
  }
  template <class F>
  void for_each_motion_field(F&& f) {
    visit_motion_fields(*this, f);
  }

 private:
  template <class Arrays, class Views>
  static void add(Arrays& arrays, Views& views) {
    for (auto& array : arrays) views.add(array.data());
  }
};

}  // namespace jaxmpm
