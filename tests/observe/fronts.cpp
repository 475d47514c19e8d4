// Fronts of clouds whose reach is known.
#include <catch2/catch.hpp>

#include "clouds.hpp"
#include "observe/clusters.hpp"
#include "observe/front.hpp"

using namespace jaxmpm;
using testing::empty_model;
using testing::fill;
using testing::read;

namespace {

const Model flat = empty_model(2, {40, 20, 1}, 0.05);  // 2 m × 1 m

deck::FrontGauge front(const std::string& axis) {
  deck::FrontGauge gauge;
  gauge.body = "sand";
  gauge.axis = axis;
  return gauge;
}

}  // namespace

TEST_CASE("quantile of a box's mass, sharp and smooth, in both directions") {
  const std::vector<BodySnapshot> box{fill(flat, 2, [](const Point& x) { return x[0] > 0.5 && x[0] < 1.5 && x[1] < 0.5; })};
  for (const double smooth : {0.0, 0.05, 0.1}) {
    deck::FrontGauge gauge = front("x");
    gauge.smooth = smooth;
    gauge.quantile = 0.75;
    CHECK(read(*make_gauge(gauge, flat), box).values[0] == Approx(1.25).margin(smooth > 0 ? 1e-9 : 0.0126));
    gauge.direction = "-";
    CHECK(read(*make_gauge(gauge, flat), box).values[0] == Approx(0.75).margin(smooth > 0 ? 1e-9 : 0.0126));
  }
  const Sample by_default = read(*make_gauge(front("x"), flat), box);
  CHECK(by_default.valid);
  CHECK(by_default.values[0] == Approx(1.5).margin(0.03));
}

TEST_CASE("the smooth quantile follows every particle smoothly") {
  std::vector<BodySnapshot> box{fill(flat, 2, [](const Point& x) { return x[0] < 1 && x[1] < 0.3; })};
  deck::FrontGauge wanted = front("x");
  wanted.quantile = 0.9;
  const auto gauge = make_gauge(wanted, flat);
  const double before = read(*gauge, box).values[0];
  for (double& x : box[0].position) x += 1e-7;
  CHECK(read(*gauge, box).values[0] - before == Approx(1e-7).epsilon(1e-4));
}

TEST_CASE("quantile against sorting, for a random cloud") {
  std::vector<Along> cloud;
  std::uint64_t random = 1;
  for (int p = 0; p < 5000; ++p) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    cloud.push_back({static_cast<double>(random >> 40) / (1 << 24), 1.0 + static_cast<double>(random >> 60)});
  }
  std::vector<Along> sorted = cloud;
  std::sort(sorted.begin(), sorted.end(), [](const Along& a, const Along& b) { return a.s < b.s; });
  double total = 0;
  for (const Along& p : sorted) total += p.amount;
  const Material material{cloud.size(),
                          [&](std::size_t begin, std::size_t end, Along* out) { std::copy(&cloud[begin], &cloud[0] + end, out); }};
  for (const double q : {0.001, 0.3, 0.5, 0.995, 0.9999}) {
    double sum = 0;
    std::size_t k = 0;
    while ((sum += sorted[k].amount) < q * total) ++k;
    CHECK(quantile_front(material, q, 0, 0.01).values[0] == sorted[k].s);
    CHECK(quantile_front(material, q, 1e-7, 0.01).values[0] == Approx(sorted[k].s).margin(2e-7));
  }
}

TEST_CASE("depth of a wedge") {
  // Depth 0.4 (1 − x/1.6): 0.1 m deep at x = 1.2.
  const auto wedge = [](const Point& x) { return x[1] < 0.4 * (1 - x[0] / 1.6); };
  deck::FrontGauge gauge = front("x");
  gauge.depth = 0.1;
  const std::vector<BodySnapshot> flat_wedge{fill(flat, 4, wedge)};
  CHECK(read(*make_gauge(gauge, flat), flat_wedge).values[0] == Approx(1.2).margin(0.03));
  gauge.smooth = 0;
  CHECK(read(*make_gauge(gauge, flat), flat_wedge).values[0] == Approx(1.2).margin(0.06));
  gauge.depth = 0.6;
  CHECK_FALSE(read(*make_gauge(gauge, flat), flat_wedge).valid);

  const Model wide = empty_model(3, {40, 4, 20}, 0.05);
  gauge = front("x");
  gauge.depth = 0.1;
  const std::vector<BodySnapshot> wide_wedge{fill(wide, 2, [&](const Point& x) { return wedge({x[0], x[2], 0}); })};
  CHECK(read(*make_gauge(gauge, wide), wide_wedge).values[0] == Approx(1.2).margin(0.04));
}

TEST_CASE("radius of a disc, whole and as a quarter in a corner") {
  for (const double corner : {0.0, -1.0}) {
    Model model = empty_model(3, {corner < 0 ? 40 : 20, corner < 0 ? 40 : 20, 8}, 0.05);
    model.domain_min = {corner, corner, 0};
    const std::vector<BodySnapshot> disc{fill(model, 2, [](const Point& x) { return x[0] * x[0] + x[1] * x[1] < 0.64 && x[2] < 0.2; })};
    deck::FrontGauge gauge = front("radius");
    gauge.center = {0, 0};
    gauge.quantile = 0.25;
    CHECK(read(*make_gauge(gauge, model), disc).values[0] == Approx(0.4).margin(0.01));
    gauge.quantile.reset();
    gauge.depth = 0.1;
    CHECK(read(*make_gauge(gauge, model), disc).values[0] == Approx(0.8).margin(0.02));
  }
}

TEST_CASE("only what is joined to the largest cluster of cells") {
  const std::vector<BodySnapshot> two{
      fill(flat, 2, [](const Point& x) { return (x[0] < 0.5 || (x[0] > 1.8 && x[0] < 1.9)) && x[1] < 0.2; })};
  deck::FrontGauge gauge = front("x");
  gauge.smooth = 0;
  CHECK(read(*make_gauge(gauge, flat), two).values[0] > 1.8);
  gauge.connected = true;
  CHECK(read(*make_gauge(gauge, flat), two).values[0] == Approx(0.5).margin(0.03));

  // Cells that touch at a corner belong together; one empty cell between them parts them.
  const auto cell = [](const Point& x, int i, int j) { return int(x[0] / 0.05) == i && int(x[1] / 0.05) == j; };
  const BodySnapshot chain =
      fill(flat, 1, [&](const Point& x) { return cell(x, 0, 0) || cell(x, 1, 1) || cell(x, 2, 0) || cell(x, 4, 0) || cell(x, 5, 0); });
  const std::vector<bool> kept = in_largest_cluster(chain, flat);
  CHECK(std::count(kept.begin(), kept.end(), true) == 3);
  for (std::size_t p = 0; p < kept.size(); ++p) CHECK(kept[p] == (chain.position[2 * p] < 0.15));
}
