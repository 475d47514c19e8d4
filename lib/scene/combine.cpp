// Union and difference of shapes. Their distances are exact where a single part is met; inside a union and outside a difference they are
// bounds from below near places where parts meet, with the right sign everywhere.
#include <algorithm>

#include "scene/geometry.hpp"

namespace jaxmpm {
namespace {

class UnionGeometry : public Geometry {
 public:
  explicit UnionGeometry(std::vector<GeometryPointer> parts) : parts_(std::move(parts)) {}

  void spans(const Point& place, Spans& out) const override {
    out.clear();
    Spans part;
    for (const GeometryPointer& p : parts_) {
      p->spans(place, part);
      if (!part.empty()) out = unite(out, part);
    }
  }

  Bounds bounds() const override {
    Bounds box = parts_[0]->bounds();
    for (const GeometryPointer& p : parts_) {
      const Bounds b = p->bounds();
      for (int d = 0; d < 3; ++d) {
        box.lower[d] = std::min(box.lower[d], b.lower[d]);
        box.upper[d] = std::max(box.upper[d], b.upper[d]);
      }
    }
    return box;
  }
  bool exact_bounds(int axis) const override {
    return std::all_of(parts_.begin(), parts_.end(), [&](const GeometryPointer& p) { return p->exact_bounds(axis); });
  }

  SignedDistance signed_distance(const Point& place) const override {
    SignedDistance least = parts_[0]->signed_distance(place);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      const SignedDistance d = parts_[i]->signed_distance(place);
      if (d.distance < least.distance) least = d;
    }
    return least;
  }

  bool may_reach(const Point& lower, const Point& upper, double reach) const override {
    return std::any_of(parts_.begin(), parts_.end(), [&](const GeometryPointer& p) { return p->may_reach(lower, upper, reach); });
  }

 private:
  std::vector<GeometryPointer> parts_;
};

class DifferenceGeometry : public Geometry {
 public:
  DifferenceGeometry(GeometryPointer from, GeometryPointer taken) : from_(std::move(from)), taken_(std::move(taken)) {}

  void spans(const Point& place, Spans& out) const override {
    from_->spans(place, out);
    if (out.empty()) return;
    Spans hole;
    taken_->spans(place, hole);
    if (!hole.empty()) out = subtract(out, hole);
  }

  Bounds bounds() const override { return from_->bounds(); }
  bool exact_bounds(int) const override { return false; }

  SignedDistance signed_distance(const Point& place) const override {
    const SignedDistance kept = from_->signed_distance(place), hole = taken_->signed_distance(place);
    return kept.distance >= -hole.distance ? kept : SignedDistance{-hole.distance, -1.0 * hole.normal};
  }

  /// max(a, −b) < reach needs a < reach.
  bool may_reach(const Point& lower, const Point& upper, double reach) const override { return from_->may_reach(lower, upper, reach); }

 private:
  GeometryPointer from_, taken_;
};

}  // namespace

GeometryPointer make_union(std::vector<GeometryPointer> parts) { return std::make_shared<UnionGeometry>(std::move(parts)); }

GeometryPointer make_difference(GeometryPointer from, GeometryPointer taken) {
  return std::make_shared<DifferenceGeometry>(std::move(from), std::move(taken));
}

}  // namespace jaxmpm
