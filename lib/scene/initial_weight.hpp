#pragma once
// The weight of the material as compression and stress of every particle (equations: scene/initial_stress.hpp), of doubles for the first
// state or of dual numbers for its derivative: one code for both.
#include <algorithm>
#include <optional>

#include "scene/line_table.hpp"
#include "scene/overburden.hpp"

namespace jaxmpm {

inline std::string stress_pointer(std::size_t body) { return "/bodies/" + std::to_string(body) + "/initial_stress"; }

/// Gravity as a unit vector, its size (m/s²) and its axis (−1 where it is along none).
template <class Real>
struct Gravity {
  std::array<Real, 3> direction{};
  Real size{};
  int axis = -1;

  /// Distance along gravity from one place to another, in the places' unit.
  Real along(const Point& from, const Point& to) const {
    return direction[0] * Real(to[0] - from[0]) + direction[1] * Real(to[1] - from[1]) + direction[2] * Real(to[2] - from[2]);
  }
};

template <class Number>
auto make_gravity(const deck::Deck& deck, const Number& number) {
  using Real = decltype(number(deck.gravity[0]));
  Gravity<Real> g;
  int components = 0;
  for (std::size_t d = 0; d < deck.gravity.size(); ++d) {
    g.direction[d] = number(deck.gravity[d]);
    if (deck.gravity[d] == 0) continue;
    ++components;
    g.axis = static_cast<int>(d);
  }
  if (components != 1) g.axis = -1;
  if (components == 0) return g;
  g.size = sqrt(g.direction[0] * g.direction[0] + g.direction[1] * g.direction[1] + g.direction[2] * g.direction[2]);
  const Real per_size = Real(1) / g.size;
  for (Real& component : g.direction) component = per_size * component;
  return g;
}

/// Vertical pressure along one line, by pieces from the top down.
template <class Real>
class LinePressure {
 public:
  LinePressure(std::vector<Piece> pieces, const std::vector<Overburden<Real>>& laws, double cell_size, const Real& g)
      : pieces_(std::move(pieces)), laws_(&laws), cell_size_(cell_size), g_(g) {
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.top < b.top; });
    Real above(0);
    double level = pieces_.front().top;
    for (Piece& piece : pieces_) {  // each takes over where the last one ends, gaps included
      gap_ = std::max(gap_, piece.top - level);
      piece.top = level;
      above_.push_back(above);
      level = std::max(level, piece.bottom);
      above = laws[piece.body].pressure(above, Real((level - piece.top) * cell_size_), g_);
    }
  }

  /// Largest gap between pieces, cells.
  double gap() const { return gap_; }

  Real at(double depth_coordinate) const {
    std::size_t k = 0;
    while (k + 1 < pieces_.size() && pieces_[k].bottom <= depth_coordinate) ++k;
    const double depth = std::max(0.0, depth_coordinate - pieces_[k].top) * cell_size_;
    return (*laws_)[pieces_[k].body].pressure(above_[k], Real(depth), g_);
  }

 private:
  std::vector<Piece> pieces_;
  std::vector<Real> above_;
  double gap_ = 0;
  const std::vector<Overburden<Real>>* laws_;
  double cell_size_;
  Real g_;
};

/// Stress tensor (tension positive) of a vertical pressure: −s (k I + (1 − k) ĝ⊗ĝ).
template <class Real>
std::array<Real, 6> stress_tensor(const Real& vertical, const Real& k, const std::array<Real, 3>& g) {
  const Real s = -vertical, rest = Real(1) - k;
  return {s * (k + rest * g[0] * g[0]), s * (k + rest * g[1] * g[1]), s * (k + rest * g[2] * g[2]),
          s * rest * g[0] * g[1],       s * rest * g[1] * g[2],       s * rest * g[0] * g[2]};
}

/// What the weight is computed from.
struct WeightedScene {
  const deck::Deck& deck;
  const Frame& frame;
  const std::vector<Seeds>& seeds;  // of the bodies; not read where columns_needed() says so
  const std::vector<Body>& bodies;  // positions
};

/// Whether any body's depth is measured along lines of material.
bool columns_needed(const deck::Deck& deck);
/// DeckError without gravity, or without a line or surface to tell the depth.
void check_gravity(const deck::InitialStress& stress, double size, int axis, std::size_t body);

/// Calls sink(body, particle, compression, stress) for every particle of body `i`, whose vertical pressure is pressure(place).
template <class Real, class Pressure, class Sink>
void fill(std::size_t i, const BodyState& state, const Overburden<Real>& law, const Gravity<Real>& gravity, const Pressure& pressure,
          Sink& sink) {
  for (std::size_t p = 0; p < state.position.size(); ++p) {
    const Real vertical = pressure(state.position[p]);
    sink(i, p, law.compression(vertical), stress_tensor(vertical, law.lateral_ratio, gravity.direction));
  }
}

template <class Real, class Sink>
void fill_below_plane(std::size_t i, const WeightedScene& scene, const Overburden<Real>& law, const Gravity<Real>& gravity, Sink& sink) {
  const Point surface = scene.frame.place(scene.deck.bodies[i].initial_stress.surface->point, stress_pointer(i) + "/surface/point");
  const auto pressure = [&](const Point& place) {
    const Real depth = max(Real(0), gravity.along(surface, place)) * Real(scene.frame.cell_size);
    return law.pressure(Real(0), depth, gravity.size);
  };
  fill(i, scene.bodies[i].initial, law, gravity, pressure, sink);
}

/// Returns the largest gap in the material above, cells.
template <class Real, class Sink>
double fill_below_material(std::size_t i, const WeightedScene& scene, const std::vector<LineTable>& tables,
                           const std::vector<Overburden<Real>>& laws, const Gravity<Real>& gravity, Sink& sink) {
  std::uint64_t line = ~std::uint64_t{0};
  double gap = 0;
  std::optional<LinePressure<Real>> of_line;
  const auto pressure = [&](const Point& place) {
    if (!of_line || tables[i].line_of(place) != line) {
      line = tables[i].line_of(place);
      std::vector<Piece> pieces;
      for (const LineTable& table : tables) table.collect(place, pieces);
      of_line.emplace(std::move(pieces), laws, scene.frame.cell_size, gravity.size);
      gap = std::max(gap, of_line->gap());
    }
    return of_line->at(value_of(gravity.direction[gravity.axis]) * place[gravity.axis]);
  };
  fill(i, scene.bodies[i].initial, laws[i], gravity, pressure, sink);
  return gap;
}

/// Calls sink(body, particle, compression, stress) for every particle of every body that asks for initial stress, in their order. Returns
/// for each body the largest gap in the material along gravity that was counted as filled, cells.
template <class Number, class Sink>
std::vector<double> spread_weight(const WeightedScene& scene, const Number& number, Sink&& sink) {
  using Real = decltype(number(scene.deck.gravity[0]));
  const Gravity<Real> gravity = make_gravity(scene.deck, number);
  std::vector<Overburden<Real>> laws;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const deck::Body& body = scene.deck.bodies[i];
    laws.push_back(make_overburden(scene.deck.materials.at(body.material), body.initial_stress, stress_pointer(i), number));
    if (body.initial_stress.kind != deck::InitialStress::Kind::none)
      check_gravity(body.initial_stress, value_of(gravity.size), gravity.axis, i);
  }
  std::vector<LineTable> tables;
  for (std::size_t i = 0; i < scene.bodies.size() && columns_needed(scene.deck); ++i)
    tables.emplace_back(scene.seeds[i], gravity.axis, value_of(gravity.direction[gravity.axis]), scene.frame.dim, i);
  std::vector<double> gaps(scene.bodies.size(), 0.0);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const deck::InitialStress& stress = scene.deck.bodies[i].initial_stress;
    if (stress.kind == deck::InitialStress::Kind::none) continue;
    if (stress.surface) fill_below_plane(i, scene, laws[i], gravity, sink);
    else gaps[i] = fill_below_material(i, scene, tables, laws, gravity, sink);
  }
  return gaps;
}

}  // namespace jaxmpm
