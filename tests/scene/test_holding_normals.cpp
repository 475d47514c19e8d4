// Which surfaces of an obstacle hold a node: corners, edges, thin walls, seams, and faces of the domain.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scene/holding_normals.hpp"
#include "scene_support.hpp"

using namespace jaxmpm;

namespace {

/// A domain of 24 cells of 1 m along each axis with one obstacle, and a body far from it.
class Scene {
 public:
  explicit Scene(const std::string& shape, const std::string& walls = "{}", int dim = 2) {
    nlohmann::json deck = {
        {"jaxmpm", 1},
        {"domain",
         {{"min", std::vector<double>(std::size_t(dim), 0.0)}, {"max", std::vector<double>(std::size_t(dim), 24.0)}, {"cell_size", 1}}},
        {"gravity", std::vector<double>(std::size_t(dim), 0.0)},
        {"time", {{"end", 1}}},
        {"output", {{"interval", 1}}},
        {"materials", {{"water", {{"model", "newtonian"}, {"density", 1000}, {"sound_speed", 10}}}}},
        {"obstacles", {{{"name", "wall"}, {"shape", nlohmann::json::parse(shape)}}}},
        {"walls", nlohmann::json::parse(walls)}};
    const std::vector<double> low(std::size_t(dim), 17.0), high(std::size_t(dim), 18.0);
    deck["bodies"] = {{{"name", "water"}, {"material", "water"}, {"shape", {{"box", {{"min", low}, {"max", high}}}}}}};
    const testing::TemporaryFile file("holding_normals.json", deck.dump());
    model_ = build_model(deck::read_deck(file.path()));
  }
  std::vector<Point> at(double x, double y, double z = 0) const { return holding_normals(model_.obstacles[0], {x, y, z}, model_); }

 private:
  Model model_;
};

/// Whether these are the normals, in any order.
bool are(const std::vector<Point>& found, const std::vector<Point>& wanted) {
  const auto has = [](const std::vector<Point>& all, const Point& n) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Point& k) { return std::abs(k[0] - n[0]) + std::abs(k[1] - n[1]) + std::abs(k[2] - n[2]) < 1e-6; });
  };
  const bool none_missing = std::all_of(wanted.begin(), wanted.end(), [&](const Point& n) { return has(found, n); });
  // A normal between others takes nothing from a velocity that those let pass.
  const auto is_between = [&](const Point& n) {
    double reach = 0;
    for (const Point& w : wanted) reach = std::max(reach, n[0] * w[0] + n[1] * w[1] + n[2] * w[2]);
    return reach > 0.4 && wanted.size() > 1;
  };
  return none_missing && std::all_of(found.begin(), found.end(), [&](const Point& n) { return has(wanted, n) || is_between(n); });
}

const Point left{-1, 0, 0}, right{1, 0, 0}, down{0, -1, 0}, up{0, 1, 0};

}  // namespace

TEST_CASE("a node is held by the nearest surface, and not at all outside") {
  const Scene scene(R"({ "box": { "min": [4, 4], "max": [12, 12] } })");
  CHECK(scene.at(3, 6).empty());
  CHECK(are(scene.at(4, 8), {left}));
  CHECK(are(scene.at(8, 11), {up}));
  CHECK(are(scene.at(11, 8), {right}));
  CHECK(are(scene.at(6, 5), {down}));
}

TEST_CASE("an edge of the solid on a node holds from both sides") {
  const Scene scene(R"({ "box": { "min": [4, 4], "max": [12, 12] } })");
  CHECK(are(scene.at(4, 12), {left, up}));
  CHECK(are(scene.at(12, 4), {right, down}));
  const Scene turned(R"({ "polygon": { "points": [[12, 12], [4, 12], [4, 4], [12, 4]] } })");
  CHECK(are(turned.at(4, 12), {left, up}));  // whatever the order of its points
}

TEST_CASE("behind a corner of free space both walls hold") {
  for (
      const char* tank :
      {R"({ "difference": [{ "box": { "min": [2, 2], "max": [14, 14] } }, { "box": { "min": [5, 5], "max": [11, 15] } }] })",
       R"({ "polygon": { "points": [[2, 2], [14, 2], [14, 14], [11, 14], [11, 5], [5, 5], [5, 14], [2, 14]] } })",
       R"({ "union": [{ "box": { "min": [2, 2], "max": [14, 5] } }, { "box": { "min": [2, 5], "max": [5, 14] } }, { "box": { "min": [11, 5], "max": [14, 14] } }] })"}) {
    INFO(tank);
    const Scene scene(tank);
    CHECK(are(scene.at(5, 5), {right, up}));
    CHECK(are(scene.at(4, 4), {right, up}));
    CHECK(are(scene.at(4, 5), {right, up}));
    CHECK(are(scene.at(11, 5), {left, up}));
    CHECK(are(scene.at(5, 8), {right}));
    CHECK(are(scene.at(8, 5), {up}));
    CHECK(are(scene.at(8, 4), {up}));
  }
}

TEST_CASE("a thin wall holds from both sides") {
  const Scene plate(R"({ "box": { "min": [7.8, 0], "max": [8.2, 10] } })"), cell(R"({ "box": { "min": [8, 0], "max": [9, 10] } })");
  CHECK(are(plate.at(8, 5), {left, right}));
  CHECK(are(cell.at(8, 5), {left, right}));
  CHECK(are(cell.at(9, 5), {left, right}));
  CHECK(are(cell.at(8, 10), {left, right, up}));
  const Scene thick(R"({ "box": { "min": [8, 0], "max": [11, 10] } })");
  CHECK(are(thick.at(8, 5), {left}));
  CHECK(are(thick.at(11, 5), {right}));
}

TEST_CASE("solid goes on where parts of a union meet") {
  const Scene floor(R"({ "union": [{ "box": { "min": [2, 2], "max": [9, 5] } }, { "box": { "min": [9, 2], "max": [16, 5] } }] })");
  for (const double x : {8.0, 9.0, 10.0})
    for (const double y : {4.0, 5.0}) CHECK(are(floor.at(x, y), {up}));
}

TEST_CASE("solid goes on behind faces of the domain, closed or periodic, and not behind open ones") {
  const std::string floor = R"({ "box": { "min": [0, 0], "max": [24, 3] } })";
  const Scene closed(floor), periodic(floor, R"({ "x_min": { "kind": "periodic" }, "x_max": { "kind": "periodic" } })");
  for (const Scene* scene : {&closed, &periodic})
    for (const double x : {0.0, 1.0, 23.0, 24.0}) {
      CHECK(are(scene->at(x, 3), {up}));
      CHECK(are(scene->at(x, 2), {up}));
    }
  const Scene open(floor, R"({ "x_max": { "kind": "open" } })");
  CHECK(are(open.at(24, 3), {right, up}));
  CHECK(are(open.at(0, 3), {up}));
}

TEST_CASE("on a face of the domain normals lie in the face") {
  const Scene slope(R"({ "polygon": { "points": [[0, 0], [10, 0], [0, 10]] } })");
  CHECK(are(slope.at(0, 9), {up}));
  CHECK(are(slope.at(9, 0), {right}));
  const Scene step(R"({ "box": { "min": [6, 0], "max": [9.5, 4] } })");
  CHECK(are(step.at(6, 0), {left}));
  CHECK(are(step.at(9, 0), {right}));
}

TEST_CASE("in three dimensions up to three walls meet") {
  const Scene tank(
      R"({ "difference": [{ "box": { "min": [2, 2, 2], "max": [14, 14, 14] } }, { "box": { "min": [5, 5, 5], "max": [11, 11, 15] } }] })",
      "{}", 3);
  CHECK(are(tank.at(5, 5, 5), {right, up, {0, 0, 1}}));
  CHECK(are(tank.at(4, 4, 4), {right, up, {0, 0, 1}}));
  CHECK(are(tank.at(5, 5, 9), {right, up}));
  CHECK(are(tank.at(8, 8, 5), {{0, 0, 1}}));
}

TEST_CASE("round solids hold along their radius, however coarse the grid") {
  const Scene ball(R"({ "sphere": { "center": [10, 10], "radius": 5 } })");
  for (const Point& node : {Point{6, 8, 0}, Point{13, 13, 0}, Point{10, 6, 0}}) {
    const std::vector<Point> found = ball.at(node[0], node[1]);
    const double r = std::hypot(node[0] - 10, node[1] - 10);
    REQUIRE(found.size() == 1);
    CHECK(found[0][0] == Approx((node[0] - 10) / r).margin(1e-9));
    CHECK(found[0][1] == Approx((node[1] - 10) / r).margin(1e-9));
  }
}

TEST_CASE("what is held from all round stands still, whichever way it came") {
  const Scene post(R"({ "sphere": { "center": [10, 10], "radius": 1.2 } })");
  const std::vector<Point> normals = post.at(10, 10);
  for (const Point& start : {Point{1, 0, 0}, Point{-1, 0, 0}, Point{0.3, -0.8, 0}}) {
    Point v = start;
    for (const Point& n : normals) {  // contact of kind separate
      const double approach = v[0] * n[0] + v[1] * n[1];
      for (std::size_t c = 0; c < 2 && approach < 0; ++c) v[c] -= approach * n[c];
    }
    CHECK(std::hypot(v[0], v[1]) < 1e-9);
  }
}
