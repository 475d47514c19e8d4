// Height maps, profiles and layers.
#include <catch2/catch.hpp>
#include <cmath>

#include "fields/random.hpp"
#include "scene_support.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {

constexpr double kEast = 247618.0, kNorth = 351625.0;

/// Grid of the plane z = 100 + 0.3 x − 0.2 y (x, y from the origin of the grid's centre values), with an optional gap.
std::string plane_grid(const std::string& anchor, bool gap = false) {
  const double step = 5, shift = anchor == "corner" ? -2.5 : 0;
  std::string text = "ncols 12\nnrows 9\nxll" + anchor + " " + std::to_string(kEast + shift) + "\nyll" + anchor + " " +
                     std::to_string(kNorth + shift) + "\ncellsize 5\nNODATA_value -9999\n";
  for (int j = 8; j >= 0; --j) {
    for (int i = 0; i < 12; ++i) text += (gap && i == 4 && j == 3 ? "-9999" : std::to_string(100 + 0.3 * i * step - 0.2 * j * step)) + " ";
    text += "\n";
  }
  return text;
}

deck::Deck terrain_deck(const std::string& file) {
  deck::HeightMap ground;
  ground.file = file;
  deck::Layer layer;
  layer.height_map = ground;
  layer.thickness = 3;
  layer.area =
      std::vector<deck::Numbers>{{kEast + 10, kNorth + 8}, {kEast + 40, kNorth + 8}, {kEast + 40, kNorth + 30}, {kEast + 10, kNorth + 30}};
  deck::Deck deck = water_deck({kEast + 2, kNorth + 3, 80}, {kEast + 50, kNorth + 35, 130}, 1, {layer});
  deck.obstacles.push_back({"ground", {ground}, deck::ContactKind::friction, 0.4});
  return deck;
}

}  // namespace

TEST_CASE("The height map of a plane gives the plane's distance, whichever way its origin is written") {
  for (const std::string anchor : {"center", "corner"}) {
    const TemporaryFile file("plane_" + anchor + ".asc", plane_grid(anchor));
    const Model model = build_model(terrain_deck(file.path()));
    const double upward = 1 / std::sqrt(1 + 0.09 + 0.04);
    RandomStream random(1);
    for (int trial = 0; trial < 1000; ++trial) {
      const Point p{48 * random.uniform(), 32 * random.uniform(), 50 * random.uniform()};
      const double height = 100 + 0.3 * (p[0] + 2) - 0.2 * (p[1] + 3) - 80;
      const SignedDistance d = model.obstacles[0].signed_distance(p);
      REQUIRE(d.distance == Approx((p[2] - height) * upward).margin(1e-5));
      REQUIRE(d.normal[0] == Approx(-0.3 * upward).margin(1e-6));
      REQUIRE(d.normal[1] == Approx(0.2 * upward).margin(1e-6));
      REQUIRE(d.normal[2] == Approx(upward).margin(1e-6));
      const Point lower{std::floor(p[0]), std::floor(p[1]), std::floor(p[2])};
      if (d.distance < 1) REQUIRE(model.obstacles[0].may_touch(lower, lower + Point{1, 1, 1}));
    }
    CHECK_FALSE(model.obstacles[0].may_touch({10, 10, 45}, {14, 14, 49}));
  }
}

TEST_CASE("A layer holds area times thickness, all of it above the ground") {
  const TemporaryFile file("layer.asc", plane_grid("center"));
  const Model model = build_model(terrain_deck(file.path()));
  CHECK(particle_count(model) == 8 * 30 * 22 * 3);
  CHECK(model.notices.empty());
  for (const Point& p : model.bodies[0].initial.position) REQUIRE(model.obstacles[0].signed_distance(p).distance >= 0);
}

TEST_CASE("An area from a file moves with the height map's offset, and its polygons are united") {
  const TemporaryFile file("offset.asc", plane_grid("center"));
  const TemporaryFile area("area.csv",
                           "# two overlapping squares\npolygon,x_m,y_m\n"
                           "1,247628,351635\n1,247638,351635\n1,247638,351645\n1,247628,351645\n"
                           "2,247633,351635\n2,247648,351635\n2,247648,351645\n2,247633,351645\n");
  deck::Deck deck = terrain_deck(file.path());
  auto& layer = std::get<deck::Layer>(deck.bodies[0].shape.kind);
  layer.area = deck::AreaFile{area.path()};
  CHECK(particle_count(build_model(deck)) == 8 * 20 * 10 * 3);
  for (auto* map : {&layer.height_map, &std::get<deck::HeightMap>(deck.obstacles[0].shape.kind)}) map->offset = {-kEast, -kNorth, -80};
  deck.domain.min = {2, 3, 0};
  deck.domain.max = {50, 35, 50};
  CHECK(particle_count(build_model(deck)) == 8 * 20 * 10 * 3);
}

TEST_CASE("Gaps and edges of the raster inside the domain are errors that name the place") {
  const TemporaryFile gap("gap.asc", plane_grid("center", true));
  std::string message;
  deck::Deck deck = terrain_deck(gap.path());
  CHECK(problem_pointer(deck, &message) == "/obstacles/0/shape/height_map/file");
  CHECK(message.find("x = 247638, y = 351640") != std::string::npos);
  const TemporaryFile whole("whole.asc", plane_grid("center"));
  deck = terrain_deck(whole.path());
  deck.domain.min[0] -= 10;
  CHECK(problem_pointer(deck, &message) == "/obstacles/0/shape/height_map/file");
  CHECK(message.find("the height map covers x from 247615.5 to 247675.5") != std::string::npos);
  deck.obstacles[0].shape.kind = deck::HeightMap{"no_such_file.asc", {}, 1};
  CHECK_THROWS_AS(build_model(deck), IoError);
  const TemporaryFile cut("cut.asc", plane_grid("center").substr(0, 400));
  deck.obstacles[0].shape.kind = deck::HeightMap{cut.path(), {}, 1};
  CHECK(problem_pointer(deck, &message) == "/obstacles/0/shape/height_map/file");
  CHECK(message.find("cut off") != std::string::npos);
}

TEST_CASE("A profile in 2D: distance, scale, layer between two ends") {
  const TemporaryFile file("profile.csv", "# a kink\nx,height\n-1,0\n4,0\n12,8\n");
  deck::HeightMap ground;
  ground.file = file.path();
  ground.offset = {0, 1};
  ground.vertical_scale = 0.5;
  deck::Layer layer{ground, 2, std::vector<deck::Numbers>{{6}, {8}}};
  deck::Deck deck = water_deck({0, 0}, {10, 10}, 1, {layer});
  deck.obstacles.push_back({"ground", {ground}, deck::ContactKind::friction, 0.4});
  const Model model = build_model(deck);
  CHECK(particle_count(model) == 4 * 2 * 2);
  const double upward = 1 / std::sqrt(1.25);
  const SignedDistance d = model.obstacles[0].signed_distance({8, 5, 0});
  CHECK(d.distance == Approx(2 * upward));
  CHECK(d.normal[0] == Approx(-0.5 * upward));
  CHECK(d.normal[1] == Approx(upward));
  CHECK(model.obstacles[0].signed_distance({2, 0.5, 0}).distance == Approx(-0.5));
  deck.domain.max[0] = 13;
  std::string message;
  CHECK(problem_pointer(deck, &message) == "/obstacles/0/shape/height_map/file");
  CHECK(message.find("ends inside the domain") != std::string::npos);
}

TEST_CASE("A layer under the domain's ceiling is refused, with the face") {
  const TemporaryFile file("ceiling.asc", plane_grid("center"));
  deck::Deck deck = terrain_deck(file.path());
  deck.domain.max[2] = 105;
  std::string message;
  CHECK(problem_pointer(deck, &message) == "/bodies/0/shape");
  CHECK(message.find("z_max") != std::string::npos);
}
