#pragma once
// Which blocks of the grid have come to rest, so that a step leaves them out (docs/theory.md, "Material at rest").
//
// A tile is quiet while all its particles move slower than the deck's speed. A block rests once the tiles in it and in the blocks around it
// have been quiet for the deck's time, and is awake as soon as that no longer holds. So a block at rest never touches one with faster
// material. Particles that enter a block at rest wake it. Who rests follows from the tiles and their times alone.
#include <optional>

#include "deck/deck.hpp"
#include "kernels/material_kernel.hpp"
#include "solvers/solver.hpp"
#include "state/blocks.hpp"

namespace jaxmpm {

template <int Dim>
class RestingBlocks {
 public:
  /// Without `rest` all tiles are awake for ever.
  explicit RestingBlocks(const std::optional<deck::Rest>& rest) : rest_(rest) {}
  bool possible() const { return rest_.has_value(); }

  /// Learns the blocks of a new sort; tiles go on as those of the same body and block before it.
  void rebuild(const Blocks<Dim>& blocks, const std::vector<std::int64_t>& tile_key);
  /// Learns from the last step of the awake tiles (`reports`: of all tiles). Returns whether select() is due: another block may rest or be
  /// awake now.
  bool learn(const std::vector<TileReport>& reports, double dt, double cell_size);
  /// Decides who rests.
  void select(const Blocks<Dim>& blocks);

  /// Tiles that are awake, ascending.
  const std::vector<std::uint32_t>& moving() const { return moving_; }
  /// Tiles that came to rest by the last select(): their particles are to be stopped.
  const std::vector<std::uint32_t>& stopped() const { return stopped_; }
  bool rests(std::size_t tile) const { return tiles_[tile].rests; }
  /// [block] whether it holds an awake tile.
  const std::vector<char>& awake_blocks() const { return awake_block_; }
  /// Largest c + |v| of the tiles at rest when they stopped, m/s.
  double fastest() const { return fastest_; }
  std::uint64_t particles() const { return particles_; }  ///< at rest

  /// One array for the checkpoint, and back; throws IoError when it does not fit the tiles.
  RawArray save() const;
  void restore(const std::vector<RawArray>& arrays, const std::vector<Tile>& tiles, const std::vector<std::int64_t>& tile_key);

 private:
  struct TileRest {
    std::uint32_t body;
    std::int64_t key;
    std::size_t particles;
    double quiet = 0;    // s
    double fastest = 0;  // c + |v| in the last step awake, m/s
    bool rests = false;
    bool same_place(const TileRest& other) const { return body == other.body && key == other.key; }
    bool before(const TileRest& other) const { return body < other.body || (body == other.body && key < other.key); }
  };
  static std::vector<TileRest> rows(const std::vector<Tile>& tiles, const std::vector<std::int64_t>& tile_key);
  void take_on(TileRest& tile, const TileRest& before) const;

  std::optional<deck::Rest> rest_;
  std::vector<TileRest> tiles_;  // in the order of Blocks::tiles: by body, then by key
  std::vector<std::uint32_t> moving_, stopped_;
  std::vector<char> awake_block_;
  double fastest_ = 0;
  std::uint64_t particles_ = 0;
};

}  // namespace jaxmpm
