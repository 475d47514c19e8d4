#pragma once
// One tile's particles on their way through the reverse step: copies that stay in a core's cache, so that what a state moves with, and the
// derivatives by it, never go to memory, and kept states are read where they lie.
#include <algorithm>
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
    const std::size_t begin = tile.begin, count = tile.end - begin;
    make_room(body, count);
    copy_material(present_at, begin, present, 0, count), copy_material(before_at, begin, before, 0, count);
    copy_material(material_places(from), begin, bars, 0, count);
    copy(body.mass, begin, present.mass, 0, count), copy(from.mass, begin, bars.mass, 0, count);
    const auto take_motion = [&](const std::vector<Array<T>>& all, std::vector<Array<T>>& into) {
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (moving) copy(all[k], begin, into[k], 0, count);
        else std::fill_n(into[k].begin(), count, T(0));
      }
    };
    take_motion(from.velocity, bars.velocity), take_motion(from.affine, bars.affine);
  }
  /// Gives the derivatives back; those by what the particles move with are zero now, and stay here.
  void close(const Tile& tile, Particles<T, Dim>& to) const {
    const std::size_t count = tile.end - tile.begin;
    copy_material(material_places(bars), 0, to, tile.begin, count), copy(bars.mass, 0, to.mass, tile.begin, count);
  }

 private:
  static void copy(const Array<T>& from, std::size_t begin, Array<T>& to, std::size_t at, std::size_t count) {
    std::memcpy(to.data() + at, from.data() + begin, count * sizeof(T));
  }
  static void copy_material(const FieldPlaces& from, std::size_t begin, Particles<T, Dim>& to, std::size_t at, std::size_t count) {
    std::size_t k = 0;
    to.for_each_material_field([&](auto& field) {
      constexpr std::size_t size = sizeof(field[0]);
      std::memcpy(field.data() + at, from[k++] + begin * size, count * size);
    });
  }
  /// For `count` particles with the fields that the body has.
  void make_room(const Particles<T, Dim>& body, std::size_t count) {
    const auto grow = [&](auto& array) {
      if (array.size() < count) array.resize(count);
    };
    for (Particles<T, Dim>* p : {&present, &before, &bars}) {
      p->position.resize(Dim), p->history.resize(body.history.size()), p->dilation.resize(body.dilation.size());
      p->for_each_material_field(grow);
      if (p == &before) continue;
      p->velocity.resize(Dim), p->affine.resize(body.affine.size());
      p->for_each_motion_field(grow), grow(p->mass);
    }
  }
};

}  // namespace jaxmpm
