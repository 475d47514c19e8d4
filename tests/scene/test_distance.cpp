// Signed distances and normals of every shape against brute force.
#include <catch2/catch.hpp>
#include <cmath>

#include "fields/random.hpp"
#include "scene/stl.hpp"
#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {

bool inside(const Geometry& g, const Point& place, int up) {
  Spans spans;
  g.spans(place, spans);
  return contains(spans, place[up]);
}

Point random_place(RandomStream& random, int dim, double lower, double upper) {
  Point place{};
  for (int d = 0; d < dim; ++d) place[d] = lower + (upper - lower) * random.uniform();
  return place;
}

/// What every exact distance must fulfil: its sign is that of the inside test, stepping back along the normal ends on the surface, and no
/// ball of that radius reaches the other side.
void check_exact(const Geometry& g, int dim, double lower, double upper) {
  RandomStream random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    const Point p = random_place(random, dim, lower, upper);
    const SignedDistance d = g.signed_distance(p);
    REQUIRE(norm(d.normal) == Approx(1).epsilon(1e-12));
    REQUIRE((d.distance < 0) == inside(g, p, dim - 1));
    const Point foot = p - d.distance * d.normal;
    REQUIRE(std::abs(g.signed_distance(foot).distance) < 1e-9);
    for (int k = 0; k < 20; ++k) {
      Point direction = random_place(random, dim, -1, 1);
      if (norm(direction) == 0) continue;
      const Point probe = p + (0.999 * std::abs(d.distance) / norm(direction)) * direction;
      REQUIRE(inside(g, probe, dim - 1) == (d.distance < 0));
    }
    const Point half{0.5, 0.5, dim == 3 ? 0.5 : 0.0};
    if (d.distance < 1) REQUIRE(g.may_reach(p - half, p + half, 1));
  }
}

/// Text STL of a box with outward triangles.
std::string stl_box(const Point& a, const Point& b, bool closed = true) {
  std::string text = "solid box\n";
  const auto vertex = [&](int corner) {
    std::string line = "vertex";
    for (int d = 0; d < 3; ++d) line += " " + std::to_string((corner >> d) & 1 ? b[d] : a[d]);
    return line + "\n";
  };
  const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int q = 0; q < (closed ? 6 : 5); ++q)
    for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int k : t) text += vertex(quads[q][k]);
      text += "endloop\nendfacet\n";
    }
  return text + "endsolid\n";
}

/// The same triangles in the binary layout.
std::string binary(const std::string& text) {
  std::string facets;
  std::uint32_t corners = 0;
  for (std::size_t at = text.find("vertex"); at != std::string::npos; at = text.find("vertex", at + 1), ++corners) {
    if (corners % 3 == 0) facets.append(12, '\0');
    float x[3];
    std::sscanf(text.c_str() + at, "vertex %f %f %f", x, x + 1, x + 2);
    facets.append(reinterpret_cast<const char*>(x), sizeof x);
    if (corners % 3 == 2) facets.append(2, '\0');
  }
  const std::uint32_t count = corners / 3;
  std::string file(80, ' ');
  file.append(reinterpret_cast<const char*>(&count), sizeof count);
  return file + facets;
}

GeometryPointer mesh_of(const std::string& path, const Frame& frame) {
  deck::Mesh mesh;
  mesh.file = path;
  return make_geometry({mesh}, frame, "/obstacles/0/shape");
}

}  // namespace

TEST_CASE("Distances of box, sphere, cylinder and polygon are exact") {
  const Frame space = unit_frame(3, 10), plane = unit_frame(2, 10);
  SECTION("box") { check_exact(*make_geometry(box({2, 3, 4}, {5, 7, 6}), space, ""), 3, 0, 10); }
  SECTION("box 2D") { check_exact(*make_geometry(box({2, 3}, {5, 7}), plane, ""), 2, 0, 10); }
  SECTION("sphere") { check_exact(*make_geometry({deck::Sphere{{5, 5, 4}, 3}}, space, ""), 3, 0, 10); }
  SECTION("disc") { check_exact(*make_geometry({deck::Sphere{{5, 4}, 3}}, plane, ""), 2, 0, 10); }
  SECTION("cylinder") { check_exact(*make_geometry({deck::Cylinder{{2, 3, 2}, {6, 7, 8}, 2}}, space, ""), 3, 0, 10); }
  SECTION("upright cylinder") { check_exact(*make_geometry({deck::Cylinder{{5, 5, 8}, {5, 5, 1}, 2}}, space, ""), 3, 0, 10); }
  SECTION("lying cylinder") { check_exact(*make_geometry({deck::Cylinder{{1, 5, 4}, {8, 5, 4}, 2}}, space, ""), 3, 0, 10); }
  SECTION("polygon, clockwise and not convex") {
    check_exact(*make_geometry({deck::Polygon{{{1, 1}, {2, 8}, {5, 4}, {9, 7}, {8, 2}, {5, 3}}}}, plane, ""), 2, 0, 10);
  }
}

TEST_CASE("Normals point out of the solid, also on the surface and at the centre") {
  const Frame plane = unit_frame(2, 10);
  const GeometryPointer ramp = make_geometry({deck::Polygon{{{0, 0}, {10, 0}, {0, 5}}}}, plane, "");
  const double length = std::sqrt(5.0);
  for (const double gap : {0.5, 1e-12, 0.0, -1e-12, -0.5}) {
    const SignedDistance d = ramp->signed_distance({4 + gap * 1 / length, 3 + gap * 2 / length, 0});
    CHECK(d.distance == Approx(gap).margin(1e-13));
    CHECK(d.normal[0] == Approx(1 / length));
    CHECK(d.normal[1] == Approx(2 / length));
  }
  const GeometryPointer disc = make_geometry({deck::Sphere{{5, 5}, 2}}, plane, "");
  CHECK(disc->signed_distance({5, 5, 0}).distance == -2);
  CHECK(norm(disc->signed_distance({5, 5, 0}).normal) == 1);
  const GeometryPointer block = make_geometry(box({2, 2}, {4, 4}), plane, "");
  CHECK(block->signed_distance({4, 3, 0}).normal == Point{1, 0, 0});
  CHECK(norm(block->signed_distance({4, 4, 0}).normal) == 1);
}

TEST_CASE("Union takes the nearer surface, difference the farther of kept and taken") {
  const Frame plane = unit_frame(2, 10);
  const GeometryPointer both = make_geometry({deck::Union{{box({1, 1}, {3, 3}), box({6, 1}, {8, 3})}}}, plane, "");
  CHECK(both->signed_distance({4, 2, 0}).distance == Approx(1));
  CHECK(both->signed_distance({5.5, 2, 0}).normal == Point{-1, 0, 0});
  const GeometryPointer ring = make_geometry({deck::Difference{{{deck::Sphere{{5, 5}, 4}}, {deck::Sphere{{5, 5}, 2}}}}}, plane, "");
  CHECK(ring->signed_distance({6, 5, 0}).distance == Approx(1));
  CHECK(ring->signed_distance({6, 5, 0}).normal[0] == Approx(-1));
  CHECK(ring->signed_distance({8.5, 5, 0}).distance == Approx(-0.5));
  CHECK(ring->signed_distance({8.5, 5, 0}).normal[0] == Approx(1));
}

TEST_CASE("A cube from a text or binary STL file is the box, and an open one is refused") {
  const Frame space = unit_frame(3, 10);
  const Point a{2, 3, 4}, b{5, 7, 6.5};
  const TemporaryFile text("box.stl", stl_box(a, b)), packed("box_binary.stl", binary(stl_box(a, b))),
      open("open.stl", stl_box(a, b, false));
  const GeometryPointer reference = make_geometry(box({a[0], a[1], a[2]}, {b[0], b[1], b[2]}), space, "");
  for (const std::string& path : {text.path(), packed.path()}) {
    const GeometryPointer mesh = mesh_of(path, space);
    check_exact(*mesh, 3, 0, 10);
    RandomStream random(3);
    for (int trial = 0; trial < 2000; ++trial) {
      const Point p = random_place(random, 3, 0, 10);
      REQUIRE(mesh->signed_distance(p).distance == Approx(reference->signed_distance(p).distance).epsilon(1e-12));
    }
  }
  // Columns through edges and corners of the triangles count once: 3 × 4 × 2.5 cells with 8 particles each, also with places on edges.
  deck::Mesh mesh;
  mesh.file = text.path();
  CHECK(particle_count(build_model(water_deck({0, 0, 0}, {10, 10, 10}, 1, {mesh}))) == 240);
  deck::Deck odd = water_deck({0, 0, 0}, {10, 10, 10}, 1, {mesh});
  odd.bodies[0].particles_per_cell = 1;
  odd.bodies[0].shape.kind = deck::Mesh{text.path(), 1, {0.5, 0.5, 0.5}};
  CHECK(particle_count(build_model(odd)) == 3 * 4 * 3);
  odd.bodies[0].shape.kind = deck::Mesh{open.path(), 1, {}};
  std::string message;
  CHECK(problem_pointer(odd, &message) == "/bodies/0/shape/mesh/file");
  CHECK(message.find("not closed") != std::string::npos);
}

TEST_CASE("A triangulated sphere: sign and distance near edges and corners") {
  // Octahedron, each face split three times, corners on the sphere.
  std::vector<Triangle> faces;
  for (int s = 0; s < 8; ++s) {
    const Point x{s & 1 ? -1.0 : 1.0, 0, 0}, y{0, s & 2 ? -1.0 : 1.0, 0}, z{0, 0, s & 4 ? -1.0 : 1.0};
    const bool odd = ((s & 1) + (s >> 1 & 1) + (s >> 2 & 1)) % 2 == 1;
    faces.push_back(odd ? Triangle{x, z, y} : Triangle{x, y, z});
  }
  for (int level = 0; level < 4; ++level) {
    std::vector<Triangle> finer;
    for (const Triangle& t : faces) {
      Point m[3];
      for (int k = 0; k < 3; ++k) {
        m[k] = t[k] + t[(k + 1) % 3];
        m[k] = (1 / norm(m[k])) * m[k];
      }
      for (int k = 0; k < 3; ++k) finer.push_back({t[k], m[k], m[(k + 2) % 3]});
      finer.push_back({m[0], m[1], m[2]});
    }
    faces = finer;
  }
  std::string text = "solid sphere\n";
  char line[120];
  for (const Triangle& t : faces)
    for (const Point& p : t) {
      std::snprintf(line, sizeof line, "vertex %.9f %.9f %.9f\n", 5 + 3 * p[0], 5 + 3 * p[1], 5 + 3 * p[2]);
      text += line;
    }
  const TemporaryFile file("sphere.stl", text);
  const Frame space = unit_frame(3, 10);
  const GeometryPointer mesh = mesh_of(file.path(), space);
  check_exact(*mesh, 3, 0.5, 9.5);
  RandomStream random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const Point p = random_place(random, 3, 0, 10);
    REQUIRE(mesh->signed_distance(p).distance == Approx(norm(p - Point{5, 5, 5}) - 3).margin(0.02));
  }
}
