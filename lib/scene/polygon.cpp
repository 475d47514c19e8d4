// A polygon in 2D.
#include "core/error.hpp"
#include "scene/outline.hpp"

namespace jaxmpm {
namespace {

class PolygonGeometry : public Geometry {
 public:
  explicit PolygonGeometry(Outline outline) : outline_(std::move(outline)) {}
  void spans(const Point& place, Spans& out) const override { outline_.spans(place[0], out); }
  Bounds bounds() const override { return outline_.bounds(); }
  SignedDistance signed_distance(const Point& place) const override { return outline_.signed_distance(place); }

 private:
  Outline outline_;
};

}  // namespace

GeometryPointer make_polygon(const deck::Polygon& shape, const Frame& frame, const std::string& pointer) {
  if (frame.dim != 2) throw DeckError(pointer, "a polygon needs a two-dimensional domain; in 3D use box, cylinder, layer or mesh");
  std::vector<Point> corners;
  for (std::size_t i = 0; i < shape.points.size(); ++i)
    corners.push_back(frame.place(shape.points[i], pointer + "/points/" + std::to_string(i)));
  return std::make_shared<PolygonGeometry>(make_outline(corners, pointer + "/points"));
}

}  // namespace jaxmpm
