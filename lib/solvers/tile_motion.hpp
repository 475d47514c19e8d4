#pragma once
// Memory for what the particles of one tile move with, or for the derivatives by it: in the reverse step neither outlives the tile, and here
// they stay in a core's cache.
#include <algorithm>
#include <vector>

#include "core/round_up.hpp"
#include "state/blocks.hpp"
#include "state/particle_view.hpp"

namespace jaxmpm {

template <class T, int Dim>
class TileMotion {
 public:
  /// What the memory holds first: anything, zeros, or what the view showed.
  enum class Start { anything, zero, copy };

  /// Becomes the motion's fields of the view, for the particles of the tile.
  void lend(const Tile& tile, ParticleView<T, Dim>& view, Start start) {
    const std::size_t count = tile.end - tile.begin, line = 64 / sizeof(T);
    const std::size_t stride = round_up(count, line) + line;  // no power of two, so that fields do not compete for places in the cache
    values_.resize(std::max(values_.size(), (view.velocity.size() + view.affine.size()) * stride));
    T* to = values_.data();
    view.for_each_motion_field([&](FieldView<T>& field) {
      if (start == Start::zero) std::fill_n(to, count, T(0));
      if (start == Start::copy) std::copy_n(field.data() + tile.begin, count, to);
      field = FieldView<T>(to - tile.begin);
      to += stride;
    });
  }

 private:
  Array<T> values_;
};

}  // namespace jaxmpm
