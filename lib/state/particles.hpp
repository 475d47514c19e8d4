#pragma once
// The particles of one body: one array per field component, in storage order (sorted by block, cell and id).
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace jaxmpm {

/// Allocator of cache-line aligned arrays that are not touched on allocation.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(64))); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(64)); }
  template <class U>
  void construct(U*) noexcept {}  // left uninitialised: every array is written before it is read
  template <class U, class... A>
  void construct(U* p, A&&... a) {
    ::new (static_cast<void*>(p)) U(std::forward<A>(a)...);
  }
  friend bool operator==(AlignedAllocator, AlignedAllocator) { return true; }
  friend bool operator!=(AlignedAllocator, AlignedAllocator) { return false; }
};
template <class T>
using Array = std::vector<T, AlignedAllocator<T>>;

/// What a step changes, in order: places and what the material carries, and what a step gathers from the grid.
template <class Fields, class F>
void visit_material_fields(Fields& p, F& f) {
  for (auto& field : p.position) f(field);
  f(p.compression);
  for (auto& field : p.history) f(field);
  for (auto& field : p.dilation) f(field);
}
template <class Fields, class F>
void visit_motion_fields(Fields& p, F& f) {
  for (auto& field : p.velocity) f(field);
  for (auto& field : p.affine) f(field);
}

/// Fields of one body. Sizes of the second level: position and velocity Dim, affine Dim·Dim or none, gradient Dim·Dim or none, dilation 1
/// or none, history as the material asks.
template <class T, int Dim>
struct Particles {
  std::vector<Array<double>> position;  // cells from domain.min
  std::vector<Array<T>> velocity;       // m/s
  Array<T> mass;                        // kg
  Array<T> compression;                 // ρ/ρ0 − 1
  std::vector<Array<T>> affine;         // 1/s, row-major: the affine matrix of APIC or the velocity gradient of TPIC
  std::vector<Array<T>> history;        // of the material: stress first where it is carried
  std::vector<Array<T>> dilation;       // tr H of the last step, only with /method/volume_averaging
  std::vector<Array<T>> gradient;       // 1/s, row-major: the material's velocity gradient, only where some output asks for it
  Array<std::uint32_t> id;

  std::size_t count() const { return id.size(); }
  /// Smallest id, 0 of no particles. A body's ids are consecutive: particle a is number id[a] − first_id() in their order.
  std::uint32_t first_id() const { return id.empty() ? 0 : *std::min_element(id.begin(), id.end()); }

  /// The field table: calls f(name, array) for every array, in a fixed order. Sort, checkpoint and memory estimate all go through it.
  template <class F>
  void for_each_field(F&& f) {
    visit(*this, f);
  }
  template <class F>
  void for_each_field(F&& f) const {
    visit(*this, f);
  }

  /// Calls f(array) for every array that a step changes (sorting moves the others as well).
  template <class F>
  void for_each_material_field(F&& f) {
    visit_material_fields(*this, f);
  }
  template <class F>
  void for_each_material_field(F&& f) const {
    visit_material_fields(*this, f);
  }
  template <class F>
  void for_each_motion_field(F&& f) {
    visit_motion_fields(*this, f);
  }
  template <class F>
  void for_each_motion_field(F&& f) const {
    visit_motion_fields(*this, f);
  }

  std::size_t bytes_per_particle() const {
    std::size_t sum = 0;
    for_each_field([&](const std::string&, const auto& array) { sum += sizeof(array[0]); });
    return sum;
  }

 private:
  template <class Self, class F>
  static void visit(Self& self, F& f) {
    const auto components = [&](const std::string& name, auto& arrays) {
      for (std::size_t k = 0; k < arrays.size(); ++k) f(name + "_" + std::to_string(k), arrays[k]);
    };
    components("position", self.position), components("velocity", self.velocity);
    f(std::string("mass"), self.mass), f(std::string("compression"), self.compression);
    components("affine", self.affine), components("history", self.history), components("dilation", self.dilation);
    components("gradient", self.gradient);
    f(std::string("id"), self.id);
  }
};

}  // namespace jaxmpm
