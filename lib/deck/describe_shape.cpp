// Shapes of bodies and obstacles.
#include "deck/descriptions.hpp"

namespace jaxmpm::deck {
namespace {

const char* const family = "shape";

/// Fills an offset that was not given with one zero per axis.
template <class T>
void no_offset(T& out, const described::Reader& reader) {
  out.offset.assign(static_cast<std::size_t>(reader.dimension()), 0.0);
}

}  // namespace

void describe(Description<Box>& d) {
  d.is("box", "A box along the axes.", family);
  d.required("min", &Box::min).unit("m").vector().help("Lower corner.");
  d.required("max", &Box::max).unit("m").vector().help("Upper corner.");
  d.check({"min", "max"}, [](const Box& box, const described::Place& place) {
    for (std::size_t i = 0; i < box.min.size() && i < box.max.size(); ++i)
      if (!(box.max[i] > box.min[i]))
        place.key("max").item(i).problem("must be above the same number of min, " + described::shown_number(box.min[i]));
  });
}

void describe(Description<Sphere>& d) {
  d.is("sphere", "A sphere; in 2D a disc.", family);
  d.required("center", &Sphere::center).unit("m").vector();
  d.required("radius", &Sphere::radius).unit("m").above(0);
}

void describe(Description<Cylinder>& d) {
  d.is("cylinder", "A circular cylinder between the centres of its two ends.", family);
  d.only_in(3);
  d.required("from", &Cylinder::from).unit("m").vector().help("Centre of one end.");
  d.required("to", &Cylinder::to).unit("m").vector().help("Centre of the other end.");
  d.required("radius", &Cylinder::radius).unit("m").above(0);
  d.check({"from", "to"}, [](const Cylinder& c, const described::Place& place) {
    if (c.from == c.to) place.problem("to", "must differ from \"from\": the cylinder has no length");
  });
}

void describe(Description<Polygon>& d) {
  d.is("polygon", "A polygon; its last point is joined to its first.", family);
  d.only_in(2);
  d.required("points", &Polygon::points).unit("m").vector().items(3).help("Corners in order.");
}

void describe(Description<Mesh>& d) {
  d.is("mesh", "The inside of a closed surface of triangles.", family);
  d.only_in(3);
  d.required("file", &Mesh::file).items(1).help("STL file, looked for beside the deck.");
  d.optional("scale", &Mesh::scale).above(0).help("Factor on the file's coordinates.");
  d.optional("offset", &Mesh::offset).unit("m").vector().otherwise("0", no_offset<Mesh>).help("Added to the scaled coordinates.");
}

void describe(Description<HeightMap>& d) {
  d.is("height_map", "The solid below a surface; the last axis is up.", family);
  d.required("file", &HeightMap::file)
      .items(1)
      .help(
          "ESRI ASCII grid (3D) or a CSV profile of two columns (2D), looked for beside the deck. Values missing inside the domain's "
          "footprint are an error.");
  d.optional("offset", &HeightMap::offset).unit("m").vector().otherwise("0", no_offset<HeightMap>).help("Added to the file's coordinates.");
  d.optional("vertical_scale", &HeightMap::vertical_scale).above(0).help("Factor on the file's heights.");
}

void describe(Description<AreaFile>& d) {
  d.is("area_file", "Polygons in plan from a file.");
  d.required("file", &AreaFile::file).items(1).help("CSV with the columns polygon, x, y; the area is the union of its polygons.");
}

void describe(Description<Layer>& d) {
  d.is("layer", "A layer on a surface.", family);
  d.required("height_map", &Layer::height_map).help("The surface it lies on.");
  d.required("thickness", &Layer::thickness).unit("m").above(0).help("Measured vertically.");
  d.required("area", &Layer::area)
      .unit("m")
      .help("Where it lies, in plan: the points of a polygon (3D) or two ends (2D), or a file of polygons.");
}

void describe(Description<Points>& d) {
  d.is("points", "Particles placed one by one by a file; only as the whole shape of a body.", family);
  d.required("file", &Points::file)
      .items(1)
      .help(
          "CSV with the columns x, y[, z] (m) and volume (m³; in 2D m², of a slice one metre thick), looked for beside the deck. Ids "
          "follow the rows.");
}

void describe(Description<Union>& d) { d.is("union", "All of several shapes.", family); }
void describe(Description<Difference>& d) { d.is("difference", "The first shape without the second.", family); }

}  // namespace jaxmpm::deck

namespace jaxmpm::described {
namespace {
Limits shape_count(std::size_t fewest, std::size_t most) {
  Limits limits;
  limits.fewest = fewest;
  limits.most = most;
  return limits;
}
Limits area_points(std::size_t fewest) {
  Limits limits;
  limits.length = Limits::Length::plan;
  limits.fewest = fewest;
  return limits;
}
using ShapeKind = decltype(deck::Shape::kind);
using Shapes = Codec<std::vector<deck::Shape>>;
}  // namespace

void Codec<deck::Shape>::read(deck::Shape& out, const Place& place, const Limits&) { Keyed<ShapeKind>::read(out.kind, place); }
Json Codec<deck::Shape>::write(const deck::Shape& in, const Limits&) { return Keyed<ShapeKind>::write(in.kind); }
Json Codec<deck::Shape>::schema(const Limits&, Schema& defs) {
  return defs.reference("shape", [&defs] { return Keyed<ShapeKind>::schema(defs); });
}

void Codec<deck::Union>::read(deck::Union& out, const Place& place, const Limits&) {
  Shapes::read(out.shapes, place, shape_count(1, SIZE_MAX));
}
Json Codec<deck::Union>::write(const deck::Union& in, const Limits&) { return Shapes::write(in.shapes, {}); }
Json Codec<deck::Union>::schema(const Limits&, Schema& defs) { return Shapes::schema(shape_count(1, SIZE_MAX), defs); }

void Codec<deck::Difference>::read(deck::Difference& out, const Place& place, const Limits&) {
  Shapes::read(out.shapes, place, shape_count(2, 2));
}
Json Codec<deck::Difference>::write(const deck::Difference& in, const Limits&) { return Shapes::write(in.shapes, {}); }
Json Codec<deck::Difference>::schema(const Limits&, Schema& defs) { return Shapes::schema(shape_count(2, 2), defs); }

void Codec<LayerArea>::read(LayerArea& out, const Place& place, const Limits&) {
  if (place.value.is_object()) return Codec<deck::AreaFile>::read(out.emplace<deck::AreaFile>(), place, {});
  const std::size_t fewest = place.reader.dimension() == 2 ? 2 : 3;
  Codec<std::vector<deck::Numbers>>::read(out.emplace<std::vector<deck::Numbers>>(), place, area_points(fewest));
}
Json Codec<LayerArea>::write(const LayerArea& in, const Limits&) {
  if (const auto* file = std::get_if<deck::AreaFile>(&in)) return Codec<deck::AreaFile>::write(*file, {});
  return Codec<std::vector<deck::Numbers>>::write(std::get<std::vector<deck::Numbers>>(in), {});
}
Json Codec<LayerArea>::schema(const Limits&, Schema& defs) {
  return {
      {"oneOf", Json::array({Codec<std::vector<deck::Numbers>>::schema(area_points(2), defs), Codec<deck::AreaFile>::schema({}, defs)})}};
}
}  // namespace jaxmpm::described
