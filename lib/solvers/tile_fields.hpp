#pragma once
// One tile's particles on their way through the reverse step: copies that stay in a core's cache, so that what a state moves with, and the
// derivatives by it, never go to memory, and kept states are read where they lie.
#include <cstddef>
#include <cstring>
#include <vector>

#include "state/blocks.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// Where the material's fields of one body begin, in their order: in its own arrays, or among the numbers of a kept state.
using FieldPlaces = std::vector<const std::byte*>;

template <class T, int Dim>
FieldPlaces material_places(const Particles<T, Dim>& p) {
  FieldPlaces places;
  p.for_each_material_field([&](const auto& field) { places.push_back(reinterpret_cast<const std::byte*>(field.data())); });
  return places;
}
/// Of a kept state; `numbers` moves on to the next body's.
template <class T, int Dim>
FieldPlaces material_places(const Particles<T, Dim>& p, const std::byte*& numbers) {
  FieldPlaces places;
  p.for_each_material_field([&](const auto& field) { places.push_back(numbers), numbers += field.size() * sizeof(field[0]); });
  return places;
}

/// Particles [0, count) of these are those of the tile.
template <class T, int Dim>
class TileFields {
 public:
  Particles<T, Dim> present, before, bars;

  /// Takes the particles of a tile of `body`, whose derivatives are `from`. `moving`: those by what it moves with are not zero.
  void open(const Tile& tile, const Particles<T, Dim>& body, const FieldPlaces& present_at, const FieldPlaces& before_at,
            const Particles<T, Dim>& from, bool moving) {
    const std::size_t count = tile.end - tile.begin;
    make_room(body, count);
    read_material(present, present_at, tile.begin, count), read_material(before, before_at, tile.begin, count);
    std::memcpy(present.mass.data(), body.mass.data() + tile.begin, count * sizeof(T));
    copy(from, tile.begin, bars, 0, count);
    for_each_pair(from.velocity, bars.velocity, [&](const Array<T>& a, Array<T>& b) { set(a, b, tile.begin, count, moving); });
    for_each_pair(from.affine, bars.affine, [&](const Array<T>& a, Array<T>& b) { set(a, b, tile.begin, count, moving); });
  }
  /// Gives the derivatives back; those by what the particles move with are zero now, and stay here.
  void close(const Tile& tile, Particles<T, Dim>& to) const { copy(bars, 0, to, tile.begin, tile.end - tile.begin); }

 private:
  template <class A, class B, class F>
  static void for_each_pair(const A& a, B& b, F f) {
    for (std::size_t k = 0; k < a.size(); ++k) f(a[k], b[k]);
  }
  static void set(const Array<T>& from, Array<T>& to, std::size_t begin, std::size_t count, bool moving) {
    if (moving) std::memcpy(to.data(), from.data() + begin, count * sizeof(T));
    else std::memset(to.data(), 0, count * sizeof(T));
  }
  /// Derivatives by mass and by the material's fields.
  static void copy(const Particles<T, Dim>& from, std::size_t begin, Particles<T, Dim>& to, std::size_t at, std::size_t count) {
    const FieldPlaces places = material_places(from);
    std::size_t k = 0;
    to.for_each_material_field([&](auto& field) {
      constexpr std::size_t size = sizeof(field[0]);
      std::memcpy(field.data() + at, places[k++] + begin * size, count * size);
    });
    std::memcpy(to.mass.data() + at, from.mass.data() + begin, count * sizeof(T));
  }
  static void read_material(Particles<T, Dim>& p, const FieldPlaces& places, std::size_t begin, std::size_t count) {
    std::size_t k = 0;
    p.for_each_material_field([&](auto& field) {
      constexpr std::size_t size = sizeof(field[0]);
      std::memcpy(field.data(), places[k++] + begin * size, count * size);
    });
  }
  /// For `count` particles with the fields that the body has.
  void make_room(const Particles<T, Dim>& body, std::size_t count) {
    for (Particles<T, Dim>* p : {&present, &before, &bars}) {
      const auto fit = [&](auto& arrays, std::size_t wanted) {
        arrays.resize(wanted);
        for (auto& array : arrays)
          if (array.size() < count) array.resize(count);
      };
      fit(p->position, Dim), fit(p->history, body.history.size()), fit(p->dilation, body.dilation.size());
      if (p->compression.size() < count) p->compression.resize(count);
      if (p == &before) continue;
      fit(p->velocity, Dim), fit(p->affine, body.affine.size());
      if (p->mass.size() < count) p->mass.resize(count);
    }
  }
};

}  // namespace jaxmpm
