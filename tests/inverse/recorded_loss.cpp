// The loss with its priors, its linearisation by differences, and what a record gives back.
#include "inverse/recorded_loss.hpp"

#include <catch2/catch.hpp>

#include "fake_objective.hpp"
#include "inverse/optimizer.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {
const char* const plain = R"("unknowns": [ { "path": "/gravity/*", "bounds": [-10, 10] } ])";
const char* const with_prior =
    R"("unknowns": [ { "path": "/gravity/0", "prior": { "mean": 2, "deviation": 0.5 } }, { "path": "/gravity/1" } ])";
void nothing() {}
}  // namespace

TEST_CASE("Loss and gradient hold the data and the priors") {
  const InverseDeck own(with_prior);
  const Unknowns unknowns(own.deck);
  GravityObjective objective;
  RecordedLoss loss(unknowns, objective, {}, nothing);
  const Variables u{1.5, -7};
  const auto at = loss.gradient(u);
  CHECK(at.loss == Approx((0.25 + 1 + 2.5 * 2.5 + 1) / 2));
  for (std::size_t i = 0; i < 2; ++i) {
    Variables above = u, below = u;
    above[i] += 1e-5;
    below[i] -= 1e-5;
    CHECK(at.gradient[i] == Approx((loss.loss(above) - loss.loss(below)) / 2e-5).epsilon(1e-8));
  }
  CHECK(loss.evaluations().size() == 5);
  CHECK(loss.evaluations()[0].gradient_seconds == 2);
  CHECK(loss.peak_bytes() == 1000);
}

TEST_CASE("Linearisation: JᵀJ and Jᵀr of data and priors, one-sided at a bound") {
  GravityObjective objective;
  const InverseDeck priors(with_prior), bounds(plain);
  const Unknowns of_priors(priors.deck), of_bounds(bounds.deck);
  RecordedLoss with_priors(of_priors, objective, {}, nothing), with_bounds(of_bounds, objective, {}, nothing);
  const double x = 1.5;
  const Variables close{1e-4, 1e-4};
  for (const double y : {-7.0, -10.0, 10.0}) {  // the last two are bounds
    const Linearisation a = with_bounds.linearise({x, y}, close);
    CHECK(a.residuals == 3);
    CHECK(a.normal(0, 0) == Approx(1 + y * y).epsilon(1e-7));
    CHECK(a.normal(0, 1) == Approx(x * y).epsilon(1e-7));
    CHECK(a.normal(1, 1) == Approx(1 + x * x).epsilon(1e-7));
    CHECK(a.gradient[1] == Approx(y + 8 + x * (x * y + 8)).epsilon(1e-7));
  }
  CHECK(with_bounds.linearise({1, -8}, close).residuals == 3);  // residuals that vanish at the minimum still count
  const Linearisation b = with_priors.linearise({x, -7}, close);
  CHECK(b.residuals == 4);
  CHECK(b.normal(0, 0) == Approx(1 + 49 + 4).epsilon(1e-7));
  CHECK(b.gradient[0] == Approx(0.5 - 7 * (8 - 10.5) - 2).epsilon(1e-7));
}

TEST_CASE("An inversion that was stopped at any evaluation ends as if it had not been") {
  const InverseDeck own(plain);
  const Unknowns unknowns(own.deck);
  for (const deck::Optimizer& optimizer : {deck::Optimizer(deck::Adam{0.5, 0.98, 80, {}}), deck::Optimizer(deck::Lbfgs{40, 10, {}}),
                                           deck::Optimizer(deck::GaussNewton{0.05, 20, {}})}) {
    GravityObjective whole_objective;
    RecordedLoss whole(unknowns, whole_objective, {}, nothing);
    minimise(optimizer, whole);
    const std::size_t count = whole.evaluations().size();
    REQUIRE(count > 5);
    CHECK(whole.best()->u[0] == Approx(1).margin(0.1));
    std::vector<RecordedEvaluation> record;
    int restarts = 0;
    for (bool done = false; !done; ++restarts) {
      GravityObjective objective;
      objective.stop_at = 9;
      RecordedLoss part(unknowns, objective, record, nothing);
      try {
        minimise(optimizer, part);
        done = true;
      } catch (const GravityObjective::Interrupted&) {
      }
      CHECK(part.evaluations().size() > record.size());
      record = part.evaluations();
    }
    CHECK(restarts > 1);
    REQUIRE(record.size() == count);
    for (std::size_t k = 0; k < count; ++k) {
      CHECK(record[k].u == whole.evaluations()[k].u);
      CHECK(record[k].derivative == whole.evaluations()[k].derivative);
      CHECK(record[k].diverged == whole.evaluations()[k].diverged);
    }
  }
}

TEST_CASE("A record of another walk is refused") {
  const InverseDeck own(plain);
  const Unknowns unknowns(own.deck);
  GravityObjective objective;
  RecordedLoss first(unknowns, objective, {}, nothing);
  first.gradient({1, 2});
  RecordedLoss second(unknowns, objective, first.evaluations(), nothing);
  CHECK_THROWS_AS(second.gradient({1, 2.5}), IoError);
  RecordedLoss third(unknowns, objective, first.evaluations(), nothing);
  CHECK_THROWS_AS(third.loss({1, 2}), IoError);
}

TEST_CASE("The best evaluation is kept, not the last, and none that diverged") {
  const InverseDeck own(plain);
  const Unknowns unknowns(own.deck);
  GravityObjective objective;
  RecordedLoss loss(unknowns, objective, {}, nothing);
  CHECK(loss.best() == nullptr);
  loss.gradient({1, -7.5});
  loss.loss({1, -8});
  loss.gradient({3, -8});
  CHECK_THROWS_AS(loss.gradient({6, -8}), NumericsError);
  CHECK(loss.best()->u == Variables{1, -8});
  CHECK(loss.evaluations().back().diverged);
}
