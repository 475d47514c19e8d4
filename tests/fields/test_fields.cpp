// Expressions, networks, random numbers, tables and rasters.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "fields/ascii_grid.hpp"
#include "fields/expression.hpp"
#include "fields/files.hpp"
#include "fields/mlp.hpp"
#include "fields/random.hpp"

using namespace jaxmpm;

TEST_CASE("Expressions of coordinates and parameters") {
  const std::map<std::string, double> parameters{{"u0", 2}, {"H", 0.5}};
  const Expression e("u0*(H-y)+sin(x)", 2, parameters, "/bodies/0/velocity/0");
  CHECK(e.value({0.3, 0.1, 0}) == Approx(2 * 0.4 + std::sin(0.3)));
  CHECK(e.parameters() == std::vector<std::string>{"H", "u0"});
  CHECK(e.text() == "u0*(H-y)+sin(x)");
  CHECK_THROWS_WITH(Expression("2*w", 2, parameters, "/a"), Catch::Contains("/a: unknown name 'w'") && Catch::Contains("x, y, H, u0"));
  CHECK_THROWS_WITH(Expression("z", 2, parameters, "/a"), Catch::Contains("unknown name 'z'"));
  CHECK(Expression("z", 3, parameters, "/a").value({0, 0, 4}) == 4);
  CHECK_THROWS_AS(Expression("2*(x", 2, parameters, "/a"), DeckError);
  CHECK_THROWS_AS(Expression("", 2, parameters, "/a"), DeckError);
  CHECK_THROWS_AS(Expression("x=3", 2, parameters, "/a"), DeckError);
  CHECK_THROWS_AS(Expression("x, y", 2, parameters, "/a"), DeckError);
  CHECK_THROWS_AS(Expression("x", 2, {{"x", 1}}, "/a"), DeckError);
}

TEST_CASE("A network is the sum it should be, and its start depends on the seed alone") {
  deck::Mlp description;
  description.inputs = {"y", "x"};
  description.hidden = {2};
  description.input_scale = {10, 1};
  description.output_scale = 3;
  REQUIRE(Mlp(description, 2, "/mlp").weights().size() == 9);
  deck::Mlp weighted = description;
  weighted.weights = {1, 2, -1, -2, 0.5, 0.25, 4, 5, 6};
  const Mlp mlp(weighted, 2, "/mlp");
  // hidden: relu(10 y + 2 x + 0.5), relu(−10 y − 2 x + 0.25)
  CHECK(mlp.value({0.1, 0.2, 0}) == Approx(3 * (4 * (2 + 0.2 + 0.5) + 6)));
  CHECK(mlp.value({-0.1, -0.2, 0}) == Approx(3 * (5 * (2 + 0.2 + 0.25) + 6)));
  weighted.activation = description.activation = "tanh";
  const Mlp smooth(weighted, 2, "/mlp");
  CHECK(smooth.value({0.1, 0.2, 0}) == Approx(3 * (4 * std::tanh(2.7) + 5 * std::tanh(-1.95) + 6)));
  weighted.input_center = {0.05, -0.1};
  CHECK(Mlp(weighted, 2, "/mlp").value({0, 0.25, 0}) == Approx(smooth.value({0.1, 0.2, 0})));  // of y and x
  weighted.input_center = {0.05};
  CHECK_THROWS_WITH(Mlp(weighted, 2, "/mlp"), Catch::Contains("/mlp/input_center"));
  weighted.input_center = {};
  CHECK(Mlp(description, 2, "/mlp").weights() == Mlp(description, 2, "/mlp").weights());
  const auto first = Mlp(description, 2, "/mlp").weights();
  description.seed = 2;
  CHECK(Mlp(description, 2, "/mlp").weights() != first);
  description.inputs = {"z", "x"};
  CHECK_THROWS_AS(Mlp(description, 2, "/mlp"), DeckError);
  weighted.weights.pop_back();
  CHECK_THROWS_WITH(Mlp(weighted, 2, "/mlp"), Catch::Contains("/mlp/weights") && Catch::Contains("9 weights, here are 8"));
}

TEST_CASE("A network's weights start with the variance of He et al.") {
  deck::Mlp description;
  description.inputs = {"x"};
  description.hidden = {100, 200};
  const Mlp mlp(description, 2, "/mlp");
  double square = 0;
  for (std::size_t k = 200; k < 200 + 100 * 200; ++k) square += mlp.weights()[k] * mlp.weights()[k];
  CHECK(square / (100 * 200) == Approx(2.0 / 100).epsilon(0.03));
  const auto biases = mlp.weights().begin() + 200 + 100 * 200;
  CHECK(*std::max_element(biases, biases + 200) == Approx(0.1).epsilon(0.05));  // 1/√100
  CHECK(*std::min_element(biases, biases + 200) == Approx(-0.1).epsilon(0.05));
  CHECK(mlp.weights().back() == 0);
}

TEST_CASE("Random numbers: reference values of SplitMix64, moments, independent streams") {
  RandomStream random(1234567);
  CHECK(random.next() == 6457827717110365317ULL);
  double sum = 0, square = 0;
  for (int k = 0; k < 100000; ++k) {
    const double x = random.normal();
    sum += x;
    square += x * x;
  }
  CHECK(std::abs(sum / 1e5) < 0.01);
  CHECK(square / 1e5 == Approx(1).epsilon(0.02));
  double mean = 0, product = 0;
  for (std::uint64_t id = 0; id < 100000; ++id) {
    const double a = RandomStream(3, id).uniform() - 0.5, b = RandomStream(3, id + 1).uniform() - 0.5;
    mean += a;
    product += a * b;
  }
  CHECK(std::abs(mean / 1e5) < 0.005);
  CHECK(std::abs(product / 1e5) < 0.001);
}

TEST_CASE("Tables and numbers") {
  double value;
  CHECK((parse_number("1e-3", value) && value == 1e-3));
  CHECK((parse_number("+2.5", value) && value == 2.5));
  CHECK_FALSE(parse_number("2.5m", value));
  CHECK_FALSE(parse_number("", value));
  const std::string path = (std::filesystem::temp_directory_path() / "jaxmpm_test_fields.csv").string();
  std::ofstream(path) << "# note\n\nid , x_m,y\n1, 2.5 ,3\r\n";
  const Table table = read_table(path, "/a");
  CHECK(table.rows == std::vector<std::vector<double>>{{1, 2.5, 3}});
  CHECK(table.column("x") == 1);
  CHECK_THROWS_WITH(table.column("z"), Catch::Contains("columns are id, x_m, y"));
  std::ofstream(path) << "x,y\n1\n";
  CHECK_THROWS_WITH(read_table(path, "/a"), Catch::Contains("line 2"));
  std::ofstream(path) << "\xEF\xBB\xBF\"x\",\"y\"\n1,2\n";  // as spreadsheets write it
  CHECK(read_table(path, "/a").column("x") == 0);
  std::ofstream(path) << "x;y\n1;2\n";
  CHECK_THROWS_WITH(read_table(path, "/a"), Catch::Contains("line 1") && Catch::Contains("separate columns by commas"));
  std::ofstream(path) << "";
  CHECK_THROWS_AS(read_table(path, "/a"), DeckError);
  std::filesystem::remove(path);
  CHECK_THROWS_WITH(read_table(path, "/a"), Catch::Contains("/a: cannot read the file"));
  CHECK_THROWS_AS(read_table(std::filesystem::temp_directory_path().string(), "/a"), IoError);
}

TEST_CASE("Raster surfaces: values at centres, ceiling above every sample") {
  Raster raster{1, 2, 0.5, 4, 3, {}};
  RandomStream random(4);
  for (int k = 0; k < 12; ++k) raster.value.push_back(random.uniform());
  const auto surface = make_raster_surface(raster);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) CHECK(surface->sample(1 + 0.5 * i, 2 + 0.5 * j).height == Approx(raster.at(i, j)));
  for (int trial = 0; trial < 1000; ++trial) {
    const double u = 0.8 + 2 * random.uniform(), v = 1.8 + 1.5 * random.uniform(), h = 1e-7;
    const SurfaceSample s = surface->sample(u, v);
    REQUIRE(s.height <= surface->ceiling(u - 0.1, v - 0.1, u + 0.1, v + 0.1, 0) + 1e-12);
    const double reach = std::sqrt(1 + s.slope[0] * s.slope[0] + s.slope[1] * s.slope[1]);
    REQUIRE(s.height + reach <= surface->ceiling(u - 0.1, v - 0.1, u + 0.1, v + 0.1, 1) + 1e-12);
    if (std::abs(std::remainder(u, 0.5)) > 1e-3 && std::abs(std::remainder(v, 0.5)) > 1e-3) {
      REQUIRE((surface->sample(u + h, v).height - s.height) / h == Approx(s.slope[0]).margin(1e-6));
      REQUIRE((surface->sample(u, v + h).height - s.height) / h == Approx(s.slope[1]).margin(1e-6));
    }
  }
}
