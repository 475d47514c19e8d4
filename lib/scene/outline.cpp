#include "scene/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

double signed_area(const std::vector<Point>& corners) {
  double twice = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return 0.5 * twice;
}

std::vector<Point> without_repeated_end(std::vector<Point> corners) {
  if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  return corners;
}

/// Point of the segment a–b nearest to p, all in the plane.
Point nearest_on_segment(const Point& p, const Point& a, const Point& b) {
  const Point edge = b - a;
  const double square = dot(edge, edge);
  if (square == 0) return a;
  return a + std::clamp(dot(p - a, edge) / square, 0.0, 1.0) * edge;
}

}  // namespace

Outline::Outline(std::vector<Point> corners) : corners_(without_repeated_end(std::move(corners))) {
  bounds_ = {corners_[0], corners_[0]};
  for (const Point& c : corners_) {
    for (int d = 0; d < 2; ++d) {
      bounds_.lower[d] = std::min(bounds_.lower[d], c[d]);
      bounds_.upper[d] = std::max(bounds_.upper[d], c[d]);
    }
  }
  turn_ = signed_area(corners_) < 0 ? -1.0 : 1.0;
}

double Outline::area() const { return std::abs(signed_area(corners_)); }

void Outline::spans(double first, Spans& out) const {
  out.clear();
  std::vector<double> crossings;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Point &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
    if ((a[0] <= first) == (b[0] <= first)) continue;
    const bool ordered = a[0] < b[0];  // the same bits from either side of a shared edge
    const Point &left = ordered ? a : b, &right = ordered ? b : a;
    crossings.push_back(left[1] + (first - left[0]) / (right[0] - left[0]) * (right[1] - left[1]));
  }
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    if (crossings[i] < crossings[i + 1]) out.push_back({crossings[i], crossings[i + 1]});
}

bool Outline::contains(const Point& place) const {
  for (int d = 0; d < 2; ++d)
    if (place[d] < bounds_.lower[d] || place[d] > bounds_.upper[d]) return false;
  Spans inside;
  spans(place[0], inside);
  return jaxmpm::contains(inside, place[1]);
}

Point Outline::edge_normal(std::size_t edge) const {
  const Point along = corners_[(edge + 1) % corners_.size()] - corners_[edge];
  const double length = norm(along);
  return {turn_ * along[1] / length, -turn_ * along[0] / length, 0};
}

SignedDistance Outline::signed_distance(const Point& place) const {
  const Point p{place[0], place[1], 0};
  double least = std::numeric_limits<double>::max();
  Point nearest{};
  std::size_t nearest_edge = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Point &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
    if (a == b) continue;
    const Point candidate = nearest_on_segment(p, a, b);
    const double square = dot(p - candidate, p - candidate);
    if (square < least) {
      least = square;
      nearest = candidate;
      nearest_edge = i;
    }
  }
  return from_nearest(p, nearest, contains(p), edge_normal(nearest_edge));
}

Outline make_outline(const std::vector<Point>& corners, const std::string& pointer) {
  if (corners.size() < 3) throw DeckError(pointer, "an outline needs at least three corners, here are " + std::to_string(corners.size()));
  Outline outline(corners);
  if (outline.area() == 0) throw DeckError(pointer, "the corners enclose no area; give them in order around the outline");
  return outline;
}

}  // namespace jaxmpm
