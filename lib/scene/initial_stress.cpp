#include "scene/initial_stress.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "scene/overburden.hpp"

namespace jaxmpm {
namespace {

using Kind = deck::InitialStress::Kind;

std::string stress_pointer(std::size_t body) { return "/bodies/" + std::to_string(body) + "/initial_stress"; }

/// Gravity as a unit vector, its size (m/s²) and its axis (−1 where it is along none).
struct Gravity {
  Point direction{};
  double size = 0;
  int axis = -1;
};

Gravity make_gravity(const deck::Deck& deck) {
  Gravity g;
  int components = 0;
  for (std::size_t d = 0; d < deck.gravity.size(); ++d) {
    g.direction[d] = deck.gravity[d];
    if (deck.gravity[d] == 0) continue;
    ++components;
    g.axis = static_cast<int>(d);
  }
  if (components != 1) g.axis = -1;
  g.size = norm(g.direction);
  if (g.size > 0) g.direction = (1 / g.size) * g.direction;
  return g;
}

/// One piece of a body along a line, by depth coordinate (cells along gravity).
struct Piece {
  double top, bottom;
  const Overburden* law;
};

/// A body's lattice cells, sorted into lines along gravity.
class LineTable {
 public:
  LineTable(const Seeds& seeds, const Gravity& gravity, int dim, const Overburden* law)
      : lattice_(seeds.lattice), axis_(gravity.axis), sign_(gravity.direction[gravity.axis]), dim_(dim), law_(law) {
    for (const LatticeRun& run : seeds.runs) add(run);
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.line != b.line ? a.line < b.line : a.first < b.first; });
    merge();
  }

  /// Adds the pieces of the line through a place.
  void collect(const Point& place, std::vector<Piece>& pieces) const {
    const std::uint64_t line = line_of(place);
    auto entry = std::lower_bound(entries_.begin(), entries_.end(), line, [](const Entry& e, std::uint64_t l) { return e.line < l; });
    for (; entry != entries_.end() && entry->line == line; ++entry) {
      const double a = sign_ * lattice_.edge(entry->first), b = sign_ * lattice_.edge(entry->last);
      pieces.push_back({std::min(a, b), std::max(a, b), law_});
    }
  }

  std::uint64_t line_of(const Point& place) const {
    std::uint64_t line = 0;
    for (int d = 0; d < dim_; ++d)
      if (d != axis_) line = (line << 32) | static_cast<std::uint32_t>(std::max(0.0, std::floor(place[d] / lattice_.spacing)));
    return line;
  }

 private:
  struct Entry {
    std::uint64_t line;
    std::int32_t first, last;
  };

  /// A run lies along the last axis: along gravity it is one entry, across gravity one for each of its places.
  void add(const LatticeRun& run) {
    if (axis_ == dim_ - 1) {
      entries_.push_back({line_index(run.column[0], dim_ == 3 ? run.column[1] : -1), run.first, run.last});
      return;
    }
    for (std::int32_t n = run.first; n < run.last; ++n) {
      const std::int32_t along = run.column[axis_];
      entries_.push_back({dim_ == 2 ? line_index(n, -1) : line_index(run.column[1 - axis_], n), along, along + 1});
    }
  }

  static std::uint64_t line_index(std::int32_t a, std::int32_t b) {
    return b < 0 ? static_cast<std::uint32_t>(a)
                 : (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
  }

  void merge() {
    std::size_t kept = 0;
    for (const Entry& e : entries_) {
      if (kept > 0 && entries_[kept - 1].line == e.line && entries_[kept - 1].last == e.first) entries_[kept - 1].last = e.last;
      else entries_[kept++] = e;
    }
    entries_.resize(kept);
  }

  Lattice lattice_;
  int axis_;
  double sign_;
  int dim_;
  const Overburden* law_;
  std::vector<Entry> entries_;
};

/// Vertical pressure along one line, by pieces from the top down.
class LinePressure {
 public:
  LinePressure(std::vector<Piece> pieces, double cell_size, double g) : pieces_(std::move(pieces)), cell_size_(cell_size), g_(g) {
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.top < b.top; });
    double above = 0, level = pieces_.front().top;
    for (Piece& piece : pieces_) {  // each takes over where the last one ends, gaps included
      piece.top = level;
      above_.push_back(above);
      level = std::max(level, piece.bottom);
      above = piece.law->pressure(above, (level - piece.top) * cell_size_, g_);
    }
  }

  double at(double depth_coordinate) const {
    std::size_t k = 0;
    while (k + 1 < pieces_.size() && pieces_[k].bottom <= depth_coordinate) ++k;
    const double depth = std::max(0.0, depth_coordinate - pieces_[k].top) * cell_size_;
    return pieces_[k].law->pressure(above_[k], depth, g_);
  }

 private:
  std::vector<Piece> pieces_;
  std::vector<double> above_;
  double cell_size_, g_;
};

/// Stress tensor (tension positive) of a vertical pressure: −s (k I + (1 − k) ĝ⊗ĝ).
std::array<double, 6> stress_tensor(double vertical, double k, const Point& g) {
  const double s = -vertical, rest = 1 - k;
  return {s * (k + rest * g[0] * g[0]), s * (k + rest * g[1] * g[1]), s * (k + rest * g[2] * g[2]),
          s * rest * g[0] * g[1],       s * rest * g[1] * g[2],       s * rest * g[0] * g[2]};
}

/// Fills a body from the vertical pressure of each particle.
template <class Pressure>
void fill(BodyState& state, const Overburden& law, const Point& gravity_direction, Pressure&& pressure) {
  state.stress.resize(state.position.size());
  for (std::size_t p = 0; p < state.position.size(); ++p) {
    const double vertical = pressure(state.position[p]);
    state.compression[p] = law.compression(vertical);
    state.stress[p] = stress_tensor(vertical, law.lateral_ratio, gravity_direction);
  }
}

void fill_below_plane(BodyState& state, const Overburden& law, const Gravity& gravity, const Point& surface, double cell_size) {
  fill(state, law, gravity.direction, [&](const Point& place) {
    return law.pressure(0, std::max(0.0, dot(place - surface, gravity.direction)) * cell_size, gravity.size);
  });
}

void fill_below_material(BodyState& state, std::size_t body, const std::vector<LineTable>& tables, const Overburden& law,
                         const Gravity& gravity, double cell_size) {
  std::uint64_t line = ~std::uint64_t{0};
  std::optional<LinePressure> pressure;
  fill(state, law, gravity.direction, [&](const Point& place) {
    if (!pressure || tables[body].line_of(place) != line) {
      line = tables[body].line_of(place);
      std::vector<Piece> pieces;
      for (const LineTable& table : tables) table.collect(place, pieces);
      pressure.emplace(std::move(pieces), cell_size, gravity.size);
    }
    return pressure->at(gravity.direction[gravity.axis] * place[gravity.axis]);
  });
}

void check_gravity(const deck::InitialStress& stress, const Gravity& gravity, std::size_t body) {
  if (gravity.size == 0) throw DeckError(stress_pointer(body), "without gravity there is no weight to bear; use \"none\"");
  if (gravity.axis < 0 && !stress.surface)
    throw DeckError(stress_pointer(body),
                    "gravity is along no axis, so that no column tells the depth; give \"surface\": { \"point\": […] }, a point of "
                    "the free surface (the plane through it across gravity)");
}

}  // namespace

void set_initial_stress(const deck::Deck& deck, const Frame& frame, const std::vector<Seeds>& seeds, std::vector<Body>& bodies) {
  const Gravity gravity = make_gravity(deck);
  std::vector<Overburden> laws;
  bool columns_needed = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const deck::InitialStress& stress = deck.bodies[i].initial_stress;
    laws.push_back(make_overburden(bodies[i].material, stress, stress_pointer(i)));
    if (stress.kind == Kind::none) continue;
    check_gravity(stress, gravity, i);
    columns_needed = columns_needed || !stress.surface;
  }
  std::vector<LineTable> tables;
  if (columns_needed)
    for (std::size_t i = 0; i < bodies.size(); ++i) tables.emplace_back(seeds[i], gravity, frame.dim, &laws[i]);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const deck::InitialStress& stress = deck.bodies[i].initial_stress;
    if (stress.kind == Kind::none) continue;
    if (stress.surface)
      fill_below_plane(bodies[i].initial, laws[i], gravity, frame.place(stress.surface->point, stress_pointer(i) + "/surface/point"),
                       frame.cell_size);
    else fill_below_material(bodies[i].initial, i, tables, laws[i], gravity, frame.cell_size);
  }
}

}  // namespace jaxmpm
