#include "solvers/resting_blocks.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "solvers/raw_array.hpp"

namespace jaxmpm {

template <int Dim>
auto RestingBlocks<Dim>::rows(const std::vector<Tile>& tiles, const std::vector<std::int64_t>& tile_key) -> std::vector<TileRest> {
  std::vector<TileRest> rows;
  for (std::size_t t = 0; t < tiles.size(); ++t) rows.push_back({tiles[t].body, tile_key[t], tiles[t].end - tiles[t].begin});
  return rows;
}

/// Nothing leaves a tile at rest, so where it has as many particles as before they are the same.
template <int Dim>
void RestingBlocks<Dim>::take_on(TileRest& tile, const TileRest& before) const {
  if (before.rests && before.particles != tile.particles) return;
  tile.quiet = before.quiet, tile.fastest = before.fastest, tile.rests = before.rests;
}

template <int Dim>
void RestingBlocks<Dim>::rebuild(const Blocks<Dim>& blocks, const std::vector<std::int64_t>& tile_key) {
  if (!possible()) {
    moving_.resize(blocks.tiles.size());
    std::iota(moving_.begin(), moving_.end(), 0u);
    return;
  }
  std::vector<TileRest> before = rows(blocks.tiles, tile_key);
  before.swap(tiles_);
  auto old = before.begin();
  for (TileRest& tile : tiles_) {  // both ascend
    while (old != before.end() && old->before(tile)) ++old;
    if (old != before.end() && old->same_place(tile)) take_on(tile, *old);
  }
}

template <int Dim>
bool RestingBlocks<Dim>::learn(const std::vector<TileReport>& reports, double dt, double cell_size) {
  bool due = false;
  for (const std::uint32_t t : moving_) {
    TileRest& tile = tiles_[t];
    const bool was_quiet = tile.quiet >= rest_->time;
    tile.quiet = reports[t].displacement * cell_size < rest_->speed * dt ? tile.quiet + dt : 0;
    tile.fastest = reports[t].fastest;
    due = due || was_quiet != (tile.quiet >= rest_->time);
  }
  return due;
}

template <int Dim>
void RestingBlocks<Dim>::select(const Blocks<Dim>& blocks) {
  constexpr std::size_t around = BlockShape<Dim, 2>::neighbours;
  std::vector<double> quiet(blocks.count(), std::numeric_limits<double>::infinity());  // of the block's own tiles
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    double& q = quiet[blocks.tiles[t].block];
    q = std::min(q, tiles_[t].quiet);
  }
  const auto rests = [&](std::size_t b) {
    for (std::size_t m = 0; m < around; ++m) {
      const int other = blocks.neighbour[b * around + m];
      if (other >= 0 && quiet[std::size_t(other)] < rest_->time) return false;
    }
    return true;
  };
  awake_block_.assign(blocks.count(), 0);
  moving_.clear(), stopped_.clear();
  fastest_ = 0, particles_ = 0;
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    TileRest& tile = tiles_[t];
    const bool rested = tile.rests;
    tile.rests = rests(blocks.tiles[t].block);
    if (!tile.rests) {
      moving_.push_back(std::uint32_t(t)), awake_block_[blocks.tiles[t].block] = 1;
      continue;
    }
    if (!rested) stopped_.push_back(std::uint32_t(t));
    fastest_ = std::max(fastest_, tile.fastest), particles_ += tile.particles;
  }
}

template <int Dim>
RawArray RestingBlocks<Dim>::save() const {
  std::vector<double> values;
  for (const TileRest& tile : tiles_) values.insert(values.end(), {tile.quiet, tile.fastest});
  return pack_array("rest", values.data(), values.size());
}

template <int Dim>
void RestingBlocks<Dim>::restore(const std::vector<RawArray>& arrays, const std::vector<Tile>& tiles,
                                 const std::vector<std::int64_t>& tile_key) {
  tiles_ = rows(tiles, tile_key);
  std::vector<double> values(2 * tiles_.size());
  unpack_array(arrays, "rest", values);
  for (std::size_t t = 0; t < tiles_.size(); ++t) tiles_[t].quiet = values[2 * t], tiles_[t].fastest = values[2 * t + 1];
}

template class RestingBlocks<2>;
template class RestingBlocks<3>;

}  // namespace jaxmpm
