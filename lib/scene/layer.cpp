// Layers of even vertical thickness upon a height map.
#include <algorithm>
#include <limits>
#include <map>

#include "core/error.hpp"
#include "fields/files.hpp"
#include "scene/ground.hpp"
#include "scene/outline.hpp"

namespace jaxmpm {
namespace {

/// Between a surface and the same surface raised, over an area.
class LayerGeometry : public Geometry {
 public:
  LayerGeometry(SurfacePointer surface, const Frame& frame, double thickness, std::vector<Outline> area)
      : surface_(surface), ground_(std::move(surface), frame), up_(frame.up()), thickness_(thickness), area_(std::move(area)) {
    bounds_ = area_[0].bounds();
    for (const Outline& outline : area_)
      for (int d = 0; d < up_; ++d) {
        bounds_.lower[d] = std::min(bounds_.lower[d], outline.bounds().lower[d]);
        bounds_.upper[d] = std::max(bounds_.upper[d], outline.bounds().upper[d]);
      }
    bounds_.lower[up_] = bounds_.upper[up_] = surface_->sample(bounds_.lower[0], bounds_.lower[1]).height;
    bounds_.upper[up_] = surface_->ceiling(bounds_.lower[0], bounds_.lower[1], bounds_.upper[0], bounds_.upper[1], 0) + thickness_;
  }

  void spans(const Point& place, Spans& out) const override {
    out.clear();
    if (!over_area(place)) return;
    const double height = surface_->sample(place[0], place[1]).height;
    out.push_back({height, height + thickness_});
  }

  Bounds bounds() const override { return bounds_; }
  bool exact_bounds(int axis) const override { return axis != up_; }

  SignedDistance signed_distance(const Point& place) const override {
    Point lowered = place;
    lowered[up_] -= thickness_;
    const SignedDistance above_top = ground_.signed_distance(lowered);
    SignedDistance below_bottom = ground_.signed_distance(place);
    below_bottom = {-below_bottom.distance, -1.0 * below_bottom.normal};
    const SignedDistance beside = footprint_distance(place);
    SignedDistance farthest = above_top;
    if (below_bottom.distance > farthest.distance) farthest = below_bottom;
    if (beside.distance > farthest.distance) farthest = beside;
    return farthest;
  }

  bool may_reach(const Point& lower, const Point& upper, double reach) const override {
    for (int d = 0; d < up_; ++d)
      if (lower[d] >= bounds_.upper[d] + reach || upper[d] <= bounds_.lower[d] - reach) return false;
    Point lowered = lower;
    lowered[up_] -= thickness_;
    return ground_.may_reach(lowered, upper, reach);
  }

 private:
  bool over_area(const Point& place) const {
    return std::any_of(area_.begin(), area_.end(), [&](const Outline& outline) { return outline.contains(footprint(place)); });
  }

  /// In 2D the outlines are strips that hold the line y = 0.
  Point footprint(const Point& place) const { return {place[0], up_ == 2 ? place[1] : 0.0, 0.0}; }

  SignedDistance footprint_distance(const Point& place) const {
    SignedDistance least{std::numeric_limits<double>::max(), {}};
    for (const Outline& outline : area_) {
      const SignedDistance d = outline.signed_distance(footprint(place));
      if (d.distance < least.distance) least = d;
    }
    return least;
  }

  SurfacePointer surface_;
  GroundGeometry ground_;
  int up_;
  double thickness_;
  std::vector<Outline> area_;
  Bounds bounds_{};
};

/// In 2D the area is an interval of x: a strip without end along y.
std::vector<Outline> interval_area(const std::vector<deck::Numbers>& ends, const Frame& frame, const std::string& pointer) {
  if (ends.size() != 2 || ends[0].empty() || ends[1].empty()) throw DeckError(pointer, "in 2D an area is two ends [x]: [[0.1], [0.4]]");
  const double far = 1e6;  // cells; beyond any domain
  const double left = frame.coordinate(ends[0][0], 0), right = frame.coordinate(ends[1][0], 0);
  return {make_outline({{left, -far, 0}, {right, -far, 0}, {right, far, 0}, {left, far, 0}}, pointer)};
}

std::vector<Outline> point_area(const std::vector<deck::Numbers>& points, const Frame& frame, const std::string& pointer) {
  std::vector<Point> corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].size() < 2) throw DeckError(pointer + "/" + std::to_string(i), "a corner of an area has two coordinates, x and y");
    corners.push_back({frame.coordinate(points[i][0], 0), frame.coordinate(points[i][1], 1), 0});
  }
  return {make_outline(corners, pointer)};
}

/// Polygons of a file in the height map's own coordinates: the map's offset is added to them, too.
std::vector<Outline> file_area(const std::string& name, const Point& offset, const Frame& frame, const std::string& pointer) {
  const Table table = read_table(frame.file(name), pointer);
  const std::size_t polygon = table.column("polygon"), x = table.column("x"), y = table.column("y");
  std::map<double, std::vector<Point>> corners;
  for (const std::vector<double>& row : table.rows)
    corners[row[polygon]].push_back({frame.coordinate(row[x] + offset[0], 0), frame.coordinate(row[y] + offset[1], 1), 0});
  std::vector<Outline> area;
  for (const auto& entry : corners) area.push_back(make_outline(entry.second, pointer));
  return area;
}

std::vector<Outline> make_area(const deck::Layer& shape, const Frame& frame, const std::string& pointer) {
  const std::string place = pointer + "/area";
  if (const auto* points = std::get_if<std::vector<deck::Numbers>>(&shape.area))
    return frame.dim == 2 ? interval_area(*points, frame, place) : point_area(*points, frame, place);
  if (frame.dim == 2) throw DeckError(place, "an area from a file needs a three-dimensional domain; in 2D give two ends: [[0.1], [0.4]]");
  return file_area(std::get<deck::AreaFile>(shape.area).file, height_map_offset(shape.height_map, frame, pointer + "/height_map"), frame,
                   place + "/file");
}

}  // namespace

GeometryPointer make_layer(const deck::Layer& shape, const Frame& frame, const std::string& pointer) {
  return std::make_shared<LayerGeometry>(load_surface(shape.height_map, frame, pointer + "/height_map"), frame,
                                         frame.length(shape.thickness), make_area(shape, frame, pointer));
}

}  // namespace jaxmpm
