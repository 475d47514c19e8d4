#pragma once
// What material at rest gives to the nodes that it shares with awake material (docs/theory.md, "Material at rest"): its mass, no momentum,
// and the internal force that it stopped with. A tile scatters once, with Δt = 1 s; the impulse of a step is that times Δt. So it is a
// function of the particles in their order and of Δt, however long they have rested.
#include "state/blocks.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

template <class T, int Dim>
class SupportArenas {
 public:
  /// `arena_size`: values of a tile's arena.
  explicit SupportArenas(std::size_t arena_size) : arena_size_(arena_size) {}

  /// Forgets all: after a sort, as the particles have another order.
  void rebuild(std::size_t tiles);
  /// Chooses the tiles at rest (`rests`(tile)) that reach one of `blocks`.
  template <class F>
  void select(const Blocks<Dim>& all, const std::vector<std::uint32_t>& blocks, const F& rests);
  /// The tiles chosen, ascending.
  const std::vector<std::uint32_t>& tiles() const { return tiles_; }

  /// Fills the arena of tile t; scatter(arena) does so with Δt = 1 s.
  template <class F>
  void fill(std::size_t t, T dt, T* arena, const F& scatter);

 private:
  std::size_t arena_size_;
  std::vector<std::uint32_t> tiles_;
  std::vector<char> known_;  // [tile] its unit arena is filled
  std::vector<T> filled_;    // [tile] Δt of its arena, s; 0: not filled
  Array<T> unit_;            // [tile][arena_size] with Δt = 1 s
};

template <class T, int Dim>
void SupportArenas<T, Dim>::rebuild(std::size_t tiles) {
  known_.assign(tiles, 0), filled_.assign(tiles, T(0));
  unit_.resize(tiles * arena_size_);
}

template <class T, int Dim>
template <class F>
void SupportArenas<T, Dim>::select(const Blocks<Dim>& all, const std::vector<std::uint32_t>& blocks, const F& rests) {
  std::vector<char> reaches(known_.size(), 0);
  for (const std::uint32_t b : blocks)
    for (std::uint32_t k = all.first_contribution[b]; k < all.first_contribution[b + 1]; ++k) reaches[all.contributions[k].tile] = 1;
  tiles_.clear();
  for (std::size_t t = 0; t < known_.size(); ++t) {
    if (!rests(t)) known_[t] = 0, filled_[t] = T(0);
    else if (reaches[t]) tiles_.push_back(std::uint32_t(t));
  }
}

template <class T, int Dim>
template <class F>
void SupportArenas<T, Dim>::fill(std::size_t t, T dt, T* arena, const F& scatter) {
  T* unit = unit_.data() + t * arena_size_;
  if (!known_[t]) scatter(unit), known_[t] = 1;
  if (filled_[t] == dt) return;
  filled_[t] = dt;
  for (std::size_t quad = 0; quad < arena_size_; quad += 4) {  // {mass, impulse}
    arena[quad] = unit[quad];
    for (std::size_t c = 1; c < 4; ++c) arena[quad + c] = dt * unit[quad + c];
  }
}

}  // namespace jaxmpm
