// Observations: loss, residuals and their derivatives, from CSV and from results of a run.
#include <catch2/catch.hpp>
#include <cmath>

#include "observed_scene.hpp"

using namespace jaxmpm;
using test::moved;
using test::ObservedScene;
using test::show;

namespace {

/// The derivative of the loss at each time along random directions of every field, against central differences to 1e-6.
void check_gradient(Observer& observer, std::vector<std::vector<BodySnapshot>> run) {
  using B = BodySnapshot;
  RandomStream random(11);
  show(observer, run);
  std::vector<SnapshotGradient> gradients;
  for (std::size_t t = 0; t < run.size(); ++t) gradients.push_back(observer.gradient(t));
  const std::vector<std::pair<std::vector<double> B::*, double>> fields{
      {&B::position, 1e-6}, {&B::velocity, 1e-4}, {&B::mass, 2e-5}, {&B::density, 1e-1}};
  for (std::size_t t = 0; t < run.size(); ++t)
    for (const auto& [field, step] : fields) {
      auto ahead = run, behind = run;
      double exact = 0, size = 0;
      for (std::size_t b = 0; b < run[t].size(); ++b)
        for (std::size_t i = 0; i < (run[t][b].*field).size(); ++i) {
          const std::vector<double>& own = gradients[t][b].*field;
          const double along = random.normal(), share = own.empty() ? 0 : own[i];
          (ahead[t][b].*field)[i] += step * along;
          (behind[t][b].*field)[i] -= step * along;
          exact += share * along;
          size += share * share;
        }
      const double measured = (show(observer, ahead) - show(observer, behind)) / (2 * step);
      INFO("time " << t << ", step " << step);
      CHECK(measured == Approx(exact).epsilon(0).margin(1e-6 * std::sqrt(size) + 1e-10));
    }
}

}  // namespace

TEST_CASE("particles from CSV: residuals with weight, sigma, mask and window, in order of times and ids") {
  const ObservedScene scene;
  scene.folder.file(
      "p.csv",
      "# observed\ntime,id,x,y,sigma,good\n0.08,7,0.2,0.1,0.5,1\n0.02,9,0.1,0.2,1,1\n0.02,7,0.3,0.1,2,1\n0.04,7,9,9,1,0\n0.1,7,8,8,1,1\n");
  const deck::Deck deck = scene.deck(
      R"({"kind": "particles", "body": "pool", "field": "position", "file": "p.csv", "weight": 4, "mask": "good", "to_time": 0.09})");
  const Model model = build_model(deck);
  const auto observer = make_observer(deck, model);
  REQUIRE(observer->times() == std::vector<double>{0.02, 0.08});
  const std::vector<std::vector<BodySnapshot>> run{moved(model, 1), moved(model, 2)};
  const double loss = show(*observer, run);
  const auto& early = run[0][0].position;
  const auto& late = run[1][0].position;
  const std::vector<double> expected{2 * (early[14] - 0.3) / 2, 2 * (early[15] - 0.1) / 2,  2 * (early[18] - 0.1),
                                     2 * (early[19] - 0.2),     2 * (late[14] - 0.2) / 0.5, 2 * (late[15] - 0.1) / 0.5};
  REQUIRE(observer->residuals().size() == expected.size());
  double half_square = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    CHECK(observer->residuals()[k] == Approx(expected[k]).epsilon(1e-14));
    half_square += 0.5 * expected[k] * expected[k];
  }
  CHECK(loss == Approx(half_square).epsilon(1e-14));
  const std::vector<Comparison> compared = observer->comparisons();
  REQUIRE(compared.size() == 1);
  CHECK(compared[0].time == std::vector<double>{0.02, 0.02, 0.08});
  CHECK(compared[0].subject == std::vector<std::size_t>{7, 9, 7});
  CHECK(compared[0].observed == std::vector<double>{0.3, 0.1, 0.1, 0.2, 0.2, 0.1});
  CHECK(compared[0].sigma == std::vector<double>{2, 1, 0.5});
  CHECK(compared[0].read[4] == Approx(late[14]).epsilon(1e-14));
  check_gradient(*observer, run);
}

TEST_CASE("positions across periodic faces are compared with the nearest image") {
  const ObservedScene scene;
  scene.folder.file("p.csv", "time,id,x,y\n0.02,7,0.98,0.1\n");
  const deck::Deck deck = scene.deck(R"({"kind": "particles", "body": "pool", "field": "position", "file": "p.csv"})");
  Model model = build_model(deck);
  const double width = model.cells[0] * model.cell_size;
  const auto residual = [&] {
    const auto observer = make_observer(deck, model);
    const std::vector<std::vector<BodySnapshot>> run{moved(model, 1)};
    show(*observer, run);
    return observer->residuals()[0] - (run[0][0].position[14] - 0.98);
  };
  CHECK(residual() == Approx(0).margin(1e-14));
  model.faces[0].kind = model.faces[1].kind = deck::ContactKind::periodic;
  CHECK(residual() == Approx(width).epsilon(1e-12));
}

TEST_CASE("velocities from another run: all, chosen and random particles, in a box") {
  const ObservedScene scene;
  const std::string kind = R"({"kind": "particles", "body": "pool", "field": "velocity", "file": "truth/results.h5")";
  const deck::Deck deck = scene.deck(kind + "}");
  const Model model = build_model(deck);
  const std::vector<std::vector<BodySnapshot>> truth{moved(model, 1), moved(model, 2), moved(model, 3)};
  test::write_results(scene.folder.directory("truth"), deck, truth);
  const std::size_t n = model.bodies[0].initial.id.size();
  const auto all = make_observer(deck, model);
  CHECK(all->times() == std::vector<double>{0, 0.02, 0.04});
  CHECK(show(*all, truth) == 0);
  CHECK(all->residuals().size() == 3 * n * 2);

  const auto some = [&](const std::string& keys) { return make_observer(scene.deck(kind + ", " + keys + "}"), model); };
  CHECK(some(R"("select": {"ids": [11, 4]}, "from_time": 0.01)")->residuals().size() == 2 * 2 * 2);
  CHECK(some(R"("every": 0.04)")->times() == std::vector<double>{0, 0.04});
  const auto random = some(R"("select": {"random": 20, "seed": 3})");
  CHECK(random->residuals().size() == 3 * 20 * 2);
  auto other = truth;
  for (auto& time : other)
    for (double& v : time[0].velocity) v += 0.5;
  CHECK(show(*random, other) == Approx(0.5 * 0.25 * 3 * 20 * 2));
  check_gradient(*random, {moved(model, 4), moved(model, 5), moved(model, 6)});
  std::size_t inside = 0;
  for (const auto& time : truth)
    for (std::size_t p = 0; p < n; ++p) inside += time[0].position[2 * p] <= 0.2;
  CHECK(some(R"("mask": {"box": {"min": [0, 0], "max": [0.2, 0.5]}})")->residuals().size() == inside * 2);
}

TEST_CASE("noise is the same in every run, of its deviation, and its own for each observation") {
  const ObservedScene scene;
  const std::string noisy =
      R"({"kind": "particles", "body": "pool", "field": "position", "file": "truth/results.h5", "noise": {"deviation": 0.01, "seed": 5}})";
  const deck::Deck deck = scene.deck(noisy + ", " + noisy);
  const Model model = build_model(deck);
  const std::vector<std::vector<BodySnapshot>> truth(40, moved(model, 1));
  test::write_results(scene.folder.directory("truth"), scene.deck(noisy), {truth.begin(), truth.begin() + 6});
  const auto first = make_observer(deck, model), second = make_observer(deck, model);
  const double loss = show(*first, truth);
  CHECK(show(*second, truth) == loss);
  CHECK(first->residuals() == second->residuals());
  const std::size_t n = first->residuals().size();
  CHECK(std::sqrt(2 * loss / static_cast<double>(n)) == Approx(0.01).epsilon(0.03));
  CHECK(first->residuals()[0] != first->residuals()[n / 2]);
  CHECK(first->residuals()[0] == Approx(-0.01 * RandomStream(5, 0).normal()).epsilon(1e-9));
}

TEST_CASE("gauges from CSV, of scalars and vectors, with times that two observations share") {
  const ObservedScene scene;
  scene.folder.file("front.csv", "time,value,sigma\n0.02,0.4,0.01\n0.04,0.45,0.02\n");
  scene.folder.file("mean.csv", "time,value_x,value_y\n0.04,0.1,0.2\n0.06,0.3,0.4\n");
  scene.folder.file("level.csv", "time,value\n0.06,0.28\n");
  const deck::Deck deck =
      scene.deck(R"({"kind": "gauge", "gauge": "front", "file": "front.csv"}, {"kind": "gauge", "gauge": "mean", "file": "mean.csv"},
                                        {"kind": "gauge", "gauge": "level", "file": "level.csv", "weight": 9})");
  const Model model = build_model(deck);
  const auto observer = make_observer(deck, model);
  REQUIRE(observer->times() == std::vector<double>{0.02, 0.04, 0.06});
  const std::vector<std::vector<BodySnapshot>> run{moved(model, 1), moved(model, 2), moved(model, 3)};
  show(*observer, run);
  const auto read = [&](const char* gauge, std::size_t t) {
    return std::visit([&](const auto& kind) { return make_gauge(kind, model); }, deck.gauges.at(gauge))
        ->measure({{}, run[t], {}, {}}, nullptr)
        .values;
  };
  const std::vector<double> expected{(read("front", 0)[0] - 0.4) / 0.01, (read("front", 1)[0] - 0.45) / 0.02,
                                     read("mean", 1)[0] - 0.1,           read("mean", 1)[1] - 0.2,
                                     read("mean", 2)[0] - 0.3,           read("mean", 2)[1] - 0.4,
                                     3 * (read("level", 2)[0] - 0.28)};
  REQUIRE(observer->residuals().size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) CHECK(observer->residuals()[k] == Approx(expected[k]).epsilon(1e-12));
  check_gradient(*observer, run);
}

TEST_CASE("averages over windows: of gauges where there is material, and of each particle for itself") {
  const ObservedScene scene;
  scene.folder.file("mean.csv", "time,value_x,value_y\n0,0.1,0.2\n0.02,0.3,0.4\n0.04,0.5,0.6\n");
  scene.folder.file("far.csv", "time,value\n0,1\n0.02,2\n0.04,3\n");
  scene.folder.file("p.csv", "time,id,x,y\n0,7,0.2,0.1\n0,9,0.1,0.2\n0.02,7,0.3,0.1\n0.02,9,0.2,0.1\n0.04,9,0.3,0.2\n");
  const deck::Deck deck = scene.deck(
      R"({"kind": "gauge", "gauge": "mean", "file": "mean.csv", "average": 0.04, "weight": 4},
         {"kind": "gauge", "gauge": "far", "file": "far.csv", "average": 1},
         {"kind": "particles", "body": "pool", "field": "position", "file": "p.csv", "average": 0.04})");
  const Model model = build_model(deck);
  const auto observer = make_observer(deck, model);
  std::vector<std::vector<BodySnapshot>> run{moved(model, 1), moved(model, 2), moved(model, 3)};
  run[1][0].position[0] = 0.85, run[1][0].position[1] = 0.35;  // material at the far gauge, once
  show(*observer, run);
  const auto read = [&](const char* gauge, std::size_t t, std::size_t k) {
    return std::visit([&](const auto& kind) { return make_gauge(kind, model); }, deck.gauges.at(gauge))
        ->measure({{}, run[t], {}, {}}, nullptr)
        .values[k];
  };
  const auto x = [&](std::size_t t, std::size_t p, std::size_t k) { return run[t][0].position[2 * p + k]; };
  const double root2 = std::sqrt(2.0);
  const std::vector<double> expected{2 * (read("mean", 0, 0) + read("mean", 1, 0) - 0.1 - 0.3) / root2,
                                     2 * (read("mean", 0, 1) + read("mean", 1, 1) - 0.2 - 0.4) / root2,
                                     2 * (read("mean", 2, 0) - 0.5),
                                     2 * (read("mean", 2, 1) - 0.6),
                                     read("far", 1, 0) - 2,
                                     (x(0, 7, 0) + x(1, 7, 0) - 0.2 - 0.3) / root2,
                                     (x(0, 7, 1) + x(1, 7, 1) - 0.1 - 0.1) / root2,
                                     (x(0, 9, 0) + x(1, 9, 0) - 0.1 - 0.2) / root2,
                                     (x(0, 9, 1) + x(1, 9, 1) - 0.2 - 0.1) / root2,
                                     x(2, 9, 0) - 0.3,
                                     x(2, 9, 1) - 0.2};
  REQUIRE(observer->residuals().size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) CHECK(observer->residuals()[k] == Approx(expected[k]).epsilon(1e-12));
  for (auto& time : run) time[0].position[0] = 0.2, time[0].position[1] = 0.2;  // the pressure far off has no scale here
  check_gradient(*observer, run);
}

TEST_CASE("a gauge from another run counts where both have material") {
  const ObservedScene scene;
  const deck::Deck deck = scene.deck(
      R"({"kind": "gauge", "gauge": "front", "file": "truth/results.h5"}, {"kind": "gauge", "gauge": "far", "file": "truth/results.h5"})");
  const Model model = build_model(deck);
  const GaugeSeries front{{{"value", "m", {}, {}}}, {0, 1, 2}, {0, 0.02, 0.04}, {1, 1, 0}, {0.5, 0.6, 0}};
  const GaugeSeries far{{{"value", "Pa", {}, {}}}, {0, 1}, {0, 0.02}, {0, 1}, {0, 7}};
  test::write_results(scene.folder.directory("truth"), deck, {}, {{"front", front}, {"far", far}});
  const auto observer = make_observer(deck, model);
  CHECK(observer->times() == std::vector<double>{0, 0.02});
  show(*observer, {moved(model, 1), moved(model, 2)});
  REQUIRE(observer->residuals().size() == 3);
  CHECK(observer->residuals()[0] != 0);
  CHECK(observer->residuals()[2] == 0);  // there is no material over there in this run
  CHECK(observer->gradient(1)[0].stress.empty());
}

TEST_CASE("profiles of a deposit, from CSV and from a frame of another run") {
  const ObservedScene scene;
  scene.folder.file("profile.csv", "x,height\n0.05,0.25\n0.25,0.3\n0.7,0.1\n");
  const deck::Deck deck = scene.deck(R"({"kind": "profile", "body": "pool", "file": "profile.csv"})");
  const Model model = build_model(deck);
  const auto observer = make_observer(deck, model);
  CHECK(observer->times() == std::vector<double>{0.1});
  const std::vector<BodySnapshot> deposit = moved(model, 1);
  show(*observer, {deposit});
  REQUIRE(observer->residuals().size() == 3);
  CHECK(observer->residuals()[2] == Approx(-0.1));  // the ground, where nothing has come to rest
  check_gradient(*observer, {deposit});

  // Masses follow from the first frame's density, as in a run.
  std::vector<std::vector<BodySnapshot>> truth{moved(model, 2), deposit};
  for (std::size_t p = 0; p < deposit[0].id.size(); ++p) truth[0][0].density[p] = deposit[0].mass[p] / 0.0025;
  test::write_results(scene.folder.directory("truth"), deck, truth);
  for (const std::string reading : {"surface", "depth"}) {
    const deck::Deck other =
        scene.deck(R"({"kind": "profile", "body": "pool", "reading": ")" + reading +
                   R"(", "time": 0.02, "file": "truth/results.h5", "mask": {"box": {"min": [0, 0], "max": [0.6, 1]}}})");
    const auto twin = make_observer(other, model);
    CHECK(twin->times() == std::vector<double>{0.02});
    CHECK(twin->residuals().size() == 6);
    CHECK(show(*twin, {deposit}) == Approx(0).margin(1e-20));
    CHECK(show(*twin, {moved(model, 3)}) > 0);
    check_gradient(*twin, {moved(model, 3)});
  }
}
