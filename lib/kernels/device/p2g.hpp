#pragma once
// Particles to grid on a device (Eqs 10–12, B.1, B.2): a team a tile. Adding to shared memory costs far more than adding to a register, so
// the particles are first sorted into the cells where they stand now; a thread then takes one component of all particles of a cell.
#include "kernels/device/cell_lists.hpp"
#include "kernels/device/shares.hpp"

namespace jaxmpm {

/// How a team's memory is divided: the arena, where there is room for it, and a chunk of the tile's particles, as many as there is room
/// for.
template <class Sch, class Gift>
struct ScatterMemory {
  using T = typename Sch::T;
  static constexpr int total = 47 * 1024, most = 256, step = sizeof(T) == 4 ? 64 : 32, nodes = Sch::Shape::arena_nodes;
  static constexpr int of_arena = SpreadArena<Sch>::size * int(sizeof(T));
  static constexpr int of_chunk(int capacity) {
    return Records<Sch, Gift>::slots(capacity) * Records<Sch, Gift>::size * int(sizeof(T)) + int(sizeof(CellLists<nodes, most>)) -
           2 * (most - capacity);
  }
  static constexpr bool arena = of_arena + of_chunk(64) <= total;
  static constexpr int bytes(int capacity) { return (arena ? of_arena : 0) + of_chunk(capacity) + 64; }
  static constexpr int largest(int capacity) { return bytes(capacity) > total ? largest(capacity - step) : capacity; }
  static constexpr int capacity = largest(most);
  using Arena = std::conditional_t<arena, SpreadArena<Sch>, PlainArena<Sch>>;
};

/// Scatters what `gift` makes of each particle.
template <class Sch, class Gift, class Space>
struct ScatterTiles {
  using T = typename Sch::T;
  using Memory = ScatterMemory<Sch, Gift>;
  using Arena = typename Memory::Arena;
  using Sums = CellSums<Sch, Gift, Arena>;
  using Record = Records<Sch, Gift>;
  static constexpr int Dim = Sch::Dim, capacity = Memory::capacity;
  using Lists = CellLists<Memory::nodes, capacity>;
  static constexpr std::size_t scratch = std::size_t(Memory::bytes(capacity));
  static constexpr int threads = capacity >= 192 ? 128 : 64, resident = sizeof(T) == 4 ? 5 : 4;
  ParticleFields<T, Dim> particles;
  TileTable<T, Dim> table;
  Gift gift;

  JAXMPM_FUNCTION void operator()(const Team<Space>& team) const {
    const Tile tile = table.tiles[team.league_rank()];
    const Index<Dim> origin = table.origin(tile);
    T* out = table.arenas + std::size_t(team.league_rank()) * Sch::arena_size;
    T* arena = Memory::arena ? team_memory<T>(team, Arena::size) : out;
    T* records = team_memory<T>(team, Record::slots(capacity) * Record::size);
    Lists& lists = *team_memory<Lists>(team, 1);
    team_for(team, Arena::size, [&](int i) { arena[i] = T(0); });
    const std::size_t chunk = chunk_size(tile.end - tile.begin);
    for (std::size_t first = tile.begin; first < tile.end; first += chunk) {
      lists.clear(team);
      team.team_barrier();
      team_for(team, int(tile.end - first < chunk ? tile.end - first : chunk), [&](int i) {
        const std::size_t p = first + std::size_t(i);
        const Cell<Sch> cell(Position<Dim>(particles, p), origin);
        gift.write(particles, p, cell, records + Record::template place<capacity>(i));
        lists.add(cell.base, i);
      });
      team.team_barrier();
      const int cells = lists.count;
      team_for(team, cells * Sums::components, [&](int k) { add_component(lists, records, lists.occupied[k % cells], k / cells, arena); });
      team.team_barrier();
    }
    Arena::hand_in(team, arena, out);
  }

 private:
  /// Particles of a chunk: equal shares of a tile, of whole storage groups.
  static JAXMPM_INLINE std::size_t chunk_size(std::size_t count) {
    constexpr std::size_t most = capacity, group = Record::apart;
    const std::size_t chunks = pieces_of(count, most), share = pieces_of(count, chunks);
    return round_up(share, group);
  }
  static JAXMPM_INLINE void add_component(const Lists& lists, const T* records, int base, int component, T* arena) {
    Sums sums;
    for (int i = lists.head[base]; i != Lists::none; i = lists.next[i]) sums.add(records + Record::template place<capacity>(i), component);
    sums.give(arena, base, component);
  }
};

}  // namespace jaxmpm
