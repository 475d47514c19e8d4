#include "scene/seeding.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "fields/files.hpp"
#include "fields/random.hpp"

namespace jaxmpm {
namespace {

constexpr double kTolerance = 1e-6;  // cells; that of the domain's own extents

std::string body_pointer(std::size_t index) { return "/bodies/" + std::to_string(index); }

[[noreturn]] void fail_outside(const deck::Body& body, std::size_t index, const Frame& frame, int axis, bool above, double reach) {
  const std::string face = std::string(1, "xyz"[axis]) + (above ? "_max" : "_min");
  const double metres = frame.domain_min[axis] + reach * frame.cell_size;
  const double wall = frame.domain_min[axis] + (above ? frame.cells[axis] * frame.cell_size : 0.0);
  throw DeckError(body_pointer(index) + "/shape", "body '" + body.name + "' reaches beyond the domain's face " + face + ": to " +
                                                      number_text(metres) + " m, where the domain ends at " + number_text(wall) +
                                                      " m; enlarge the domain or move the body");
}

/// Compares the extent of a box along one axis with the domain.
void check_inside(const Bounds& box, int axis, const deck::Body& body, std::size_t index, const Frame& frame) {
  if (box.lower[axis] < -kTolerance) fail_outside(body, index, frame, axis, false, box.lower[axis]);
  if (box.upper[axis] > frame.cells[axis] + kTolerance) fail_outside(body, index, frame, axis, true, box.upper[axis]);
}

bool overlap(const Bounds& a, const Bounds& b, int dim) {
  for (int d = 0; d < dim; ++d)
    if (a.upper[d] <= b.lower[d] || b.upper[d] <= a.lower[d]) return false;
  return true;
}

/// Seeds one body, column by column.
class BodySeeder {
 public:
  BodySeeder(const deck::Deck& deck, const Frame& frame, std::size_t index, const std::vector<GeometryPointer>& shapes,
             const std::vector<GeometryPointer>& obstacles)
      : deck_(deck), frame_(frame), index_(index), shapes_(shapes), shape_(*shapes[index]), bounds_(shape_.bounds()) {
    for (const GeometryPointer& obstacle : obstacles)
      if (overlap(bounds_, obstacle->bounds(), frame.dim)) obstacles_.push_back(obstacle.get());
    for (std::size_t j = 0; j < shapes.size(); ++j)
      if (j != index && overlap(bounds_, shapes[j]->bounds(), frame.dim)) neighbours_.push_back(j);
  }

  Seeds seed() {
    if (const auto* points = dynamic_cast<const PointsGeometry*>(&shape_)) return seed_points(points->placed());
    seeds_.lattice = make_lattice(body(), frame_, body_pointer(index_));
    check_extent();
    const std::int64_t first = seeds_.lattice.first_at_or_above(bounds_.lower[0]),
                       last = seeds_.lattice.first_at_or_above(bounds_.upper[0]);
    for (std::int64_t i = first; i <= last; ++i) seed_slice(i);
    if (seeds_.count == 0) fail_empty();
    return std::move(seeds_);
  }

 private:
  const deck::Body& body() const { return deck_.bodies[index_]; }

  /// What stands where obstacles or other bodies are is an error of the file: it is not cut, as its volumes are its own.
  Seeds seed_points(const PlacedPoints& points) {
    seeds_.points = points;
    seeds_.count = seeds_.points->position.size();
    for (std::size_t p = 0; p < seeds_.count; ++p) {
      const Point& place = seeds_.points->position[p];
      const auto inside = [&](const Geometry& shape) {
        shape.spans(place, other_);
        return contains(other_, place[frame_.up()]);
      };
      const auto fail = [&](const std::string& what) {
        bad_file(body_pointer(index_) + "/shape/points/file", seeds_.points->file, seeds_.points->lines[p],
                 frame_.text(place) + " lies inside " + what + "; leave the particle out or move one of the two");
      };
      if (std::any_of(obstacles_.begin(), obstacles_.end(), [&](const Geometry* o) { return inside(*o); })) fail("an obstacle");
      for (const std::size_t j : neighbours_)
        if (inside(*shapes_[j])) fail("body '" + deck_.bodies[j].name + "'");
    }
    return std::move(seeds_);
  }

  /// Where the bounds are only rough, the columns are checked one by one; with a shape far larger than the domain there would be no end to
  /// them.
  void check_extent() const {
    for (int d = 0; d < frame_.dim; ++d)
      if (shape_.exact_bounds(d) || bounds_.upper[d] - bounds_.lower[d] > 100.0 * frame_.cells[d])
        check_inside(bounds_, d, body(), index_, frame_);
  }

  void seed_slice(std::int64_t i) {
    Point place{seeds_.lattice.place(i), 0, 0};
    if (frame_.dim == 2) return seed_column(place, i, 0);
    const std::int64_t first = seeds_.lattice.first_at_or_above(bounds_.lower[1]),
                       last = seeds_.lattice.first_at_or_above(bounds_.upper[1]);
    for (std::int64_t j = first; j <= last; ++j) {
      place[1] = seeds_.lattice.place(j);
      seed_column(place, i, j);
    }
  }

  void seed_column(const Point& place, std::int64_t i, std::int64_t j) {
    shape_.spans(place, solid_);
    if (solid_.empty()) return;
    check_column(place);
    const std::uint64_t all = count(solid_);
    for (const Geometry* obstacle : obstacles_) {
      obstacle->spans(place, other_);
      if (!other_.empty()) solid_ = subtract(solid_, other_);
    }
    const std::uint64_t kept = count(solid_);
    seeds_.cut += all - kept;
    check_overlap(place);
    for (const Span& span : solid_) add_run(span, i, j);
  }

  void add_run(const Span& span, std::int64_t i, std::int64_t j) {
    const std::int64_t first = seeds_.lattice.first_at_or_above(span.lower), last = seeds_.lattice.first_at_or_above(span.upper);
    if (first >= last) return;
    seeds_.runs.push_back(
        {{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}, static_cast<std::int32_t>(first), static_cast<std::int32_t>(last)});
    seeds_.count += static_cast<std::uint64_t>(last - first);
  }

  std::uint64_t count(const Spans& spans) const {
    std::int64_t n = 0;
    for (const Span& s : spans) n += seeds_.lattice.first_at_or_above(s.upper) - seeds_.lattice.first_at_or_above(s.lower);
    return static_cast<std::uint64_t>(n);
  }

  void check_column(Point place) const {
    const int up = frame_.up();
    Bounds column{place, place};
    column.lower[up] = solid_.front().lower;
    column.upper[up] = solid_.back().upper;
    for (int d = 0; d < frame_.dim; ++d)
      if (!shape_.exact_bounds(d)) check_inside(column, d, body(), index_, frame_);
  }

  void check_overlap(Point place) {
    for (const std::size_t j : neighbours_) {
      shapes_[j]->spans(place, other_);
      if (other_.empty()) continue;
      for (const Span& span : solid_) {
        const Spans free = subtract({span}, other_);
        if (count(free) == count({span})) continue;
        place[frame_.up()] = std::max(span.lower, other_.front().lower);
        fail_overlap(j, place);
      }
    }
  }

  [[noreturn]] void fail_overlap(std::size_t other, const Point& place) const {
    throw DeckError(body_pointer(std::max(index_, other)), "bodies '" + deck_.bodies[std::min(index_, other)].name + "' and '" +
                                                               deck_.bodies[std::max(index_, other)].name + "' overlap near " +
                                                               frame_.text(place) + "; move one, or cut it with \"difference\"");
  }

  [[noreturn]] void fail_empty() const {
    std::string why = "; make the shape larger or the lattice finer (cell_size, particles_per_cell, spacing)";
    if (seeds_.cut > 0) why = ": all of its " + std::to_string(seeds_.cut) + " particles lie inside an obstacle; move one of the two";
    throw DeckError(body_pointer(index_) + "/shape", "body '" + body().name + "' holds no particle" + why);
  }

  const deck::Deck& deck_;
  const Frame& frame_;
  std::size_t index_;
  const std::vector<GeometryPointer>& shapes_;
  const Geometry& shape_;
  Bounds bounds_;
  std::vector<const Geometry*> obstacles_;
  std::vector<std::size_t> neighbours_;
  Spans solid_, other_;
  Seeds seeds_;
};

bool holds(const Geometry& shape, const Point& place, int up, Spans& scratch) {
  shape.spans(place, scratch);
  return contains(scratch, place[up]);
}

}  // namespace

double Seeds::volume(std::size_t p, const Frame& frame) const {
  return points ? points->volume[p] : std::pow(lattice.spacing * frame.cell_size, frame.dim);
}

std::vector<GeometryPointer> obstacle_shapes(const deck::Deck& deck, const Frame& frame) {
  std::vector<GeometryPointer> shapes;
  for (std::size_t i = 0; i < deck.obstacles.size(); ++i)
    shapes.push_back(make_geometry(deck.obstacles[i].shape, frame, "/obstacles/" + std::to_string(i) + "/shape"));
  return shapes;
}

SeededScene seed_bodies(const deck::Deck& deck, const Frame& frame, const std::vector<GeometryPointer>& obstacles) {
  SeededScene scene;
  for (std::size_t i = 0; i < deck.bodies.size(); ++i)
    scene.shapes.push_back(make_geometry(deck.bodies[i].shape, frame, body_pointer(i) + "/shape"));
  for (std::size_t i = 0; i < deck.bodies.size(); ++i) scene.seeds.push_back(BodySeeder(deck, frame, i, scene.shapes, obstacles).seed());
  return scene;
}

std::vector<Point> seed_positions(const deck::Body& body, const Frame& frame, const Geometry& shape, const Seeds& seeds,
                                  const std::vector<GeometryPointer>& obstacles, std::uint32_t first_id) {
  if (seeds.points) return seeds.points->position;
  std::vector<Point> positions;
  positions.reserve(seeds.count);
  const int up = frame.up();
  Spans scratch;
  const auto allowed = [&](const Point& place) {
    return holds(shape, place, up, scratch) &&
           std::none_of(obstacles.begin(), obstacles.end(), [&](const GeometryPointer& o) { return holds(*o, place, up, scratch); });
  };
  for (const LatticeRun& run : seeds.runs) {
    Point place{};
    for (int d = 0; d < up; ++d) place[d] = seeds.lattice.place(run.column[d]);
    for (std::int32_t n = run.first; n < run.last; ++n) {
      place[up] = seeds.lattice.place(n);
      Point moved = place;
      if (body.jitter) {
        RandomStream random(body.jitter->seed, first_id + positions.size());
        for (int d = 0; d < frame.dim; ++d) moved[d] += body.jitter->fraction * seeds.lattice.spacing * (random.uniform() - 0.5);
        if (!allowed(moved)) moved = place;
      }
      positions.push_back(moved);
    }
  }
  return positions;
}

}  // namespace jaxmpm
