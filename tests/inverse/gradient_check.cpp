// The check of a gradient: what a right one, a wrong one and a kink look like.
#include "inverse/gradient_check.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "fake_objective.hpp"

using namespace jaxmpm;
using namespace jaxmpm::testing;

namespace {

const char* const two = R"("unknowns": [ { "path": "/gravity/0", "start": 0.5, "bounds": [-4, 4] },
                                         { "path": "/gravity/1", "start": -9, "prior": { "mean": -9.5, "deviation": 0.25 } } ])";

/// One component of the gradient is wrong by a part of itself.
class WrongObjective : public GravityObjective {
 public:
  explicit WrongObjective(double part) : part_(part) {}
  Evaluation gradient(const Values& values) override {
    Evaluation found = GravityObjective::gradient(values);
    found.gradient["/gravity/1"][0] *= 1 + part_;
    return found;
  }

 private:
  double part_;
};

/// The gradient is right where it is taken, but the loss bends at some ten places around it, as where particles come into contact.
class BentObjective : public GravityObjective {
 public:
  Evaluation loss(const Values& values) override {
    Evaluation found = GravityObjective::loss(values);
    for (int k = 1; k < 12; ++k)
      bent_ += 2 * std::max(0.0, std::abs(values.at("/gravity/0")[0] - 0.5) - 0.7 * std::pow(4.0, -k)) * std::pow(2.0, -k);
    found.loss += bent_ * bent_ / 2;
    residuals_ = GravityObjective::residuals();
    residuals_.push_back(bent_);
    bent_ = 0;
    return found;
  }
  Evaluation gradient(const Values& values) override {
    Evaluation found = GravityObjective::gradient(values);
    residuals_ = GravityObjective::residuals();
    residuals_.push_back(0);
    return found;
  }
  const std::vector<double>& residuals() const override { return residuals_; }

 private:
  double bent_ = 0;
  std::vector<double> residuals_;
};

/// The gradient is right, but the loss has small jumps, as where particles reach new nodes at a free surface.
class JumpyObjective : public GravityObjective {
 public:
  Evaluation loss(const Values& values) override {
    Evaluation found = GravityObjective::loss(values);
    residuals_ = GravityObjective::residuals();
    residuals_.push_back(1 + 3e-8 * double(std::llround(values.at("/gravity/0")[0] / 3e-5) % 2));
    return found;
  }
  Evaluation gradient(const Values& values) override {
    Evaluation found = GravityObjective::gradient(values);
    residuals_ = GravityObjective::residuals();
    residuals_.push_back(1);
    return found;
  }
  const std::vector<double>& residuals() const override { return residuals_; }

 private:
  std::vector<double> residuals_;
};

/// The gradient is right, but the loss jumps close by, as where a particle is about to touch a wall.
class JumpObjective : public JumpyObjective {
 public:
  Evaluation loss(const Values& values) override {
    Evaluation found = JumpyObjective::loss(values);
    jumped_ = JumpyObjective::residuals();
    jumped_.back() = values.at("/gravity/0")[0] > 0.5 + 2e-7 ? 1.001 : 1;
    return found;
  }
  Evaluation gradient(const Values& values) override {
    Evaluation found = JumpyObjective::gradient(values);
    jumped_ = JumpyObjective::residuals();
    return found;
  }
  const std::vector<double>& residuals() const override { return jumped_; }

 private:
  std::vector<double> jumped_;
};

}  // namespace

TEST_CASE("A right gradient has remainders of second order, and agrees with differences and dot products") {
  const InverseDeck own(two);
  const Unknowns unknowns(own.deck);
  GravityObjective objective;
  const GradientCheck check = check_gradient(unknowns, objective, 5, 1);
  INFO(check.verdict);
  CHECK(check.good);
  CHECK(check.particle_steps == 1000);
  REQUIRE(check.directions.size() == 5);
  for (const DirectionCheck& one : check.directions) {
    CHECK(one.slope == Approx(2).margin(0.1));
    CHECK(one.difference == Approx(one.derivative).epsilon(1e-6));
    CHECK(one.dot_product == Approx(one.derivative).epsilon(1e-6));
    CHECK(one.step.front() / one.step.back() == Approx(1e5));
  }
  REQUIRE(check.variables.size() == 2);
  CHECK(check.variables[0].label == "/gravity/0");
  CHECK(check.variables[0].derivative == Approx(0.5 - 1 - 9 * (0.5 * -9 + 8)));
  CHECK(check.variables[1].derivative == Approx(-1 + 0.5 * (0.5 * -9 + 8) + 0.5 / 0.0625));
  for (const VariableCheck& one : check.variables) CHECK(one.error < 1e-8);
  CHECK(check_gradient(unknowns, objective, 2, 1).directions[1].derivative == check.directions[1].derivative);
  CHECK(check_gradient(unknowns, objective, 2, 2).directions[1].derivative != check.directions[1].derivative);
}

TEST_CASE("A gradient that is wrong by a thousandth or more is called so") {
  const InverseDeck own(two);
  const Unknowns unknowns(own.deck);
  for (const double part : {-1.0, 0.1, 0.001}) {
    WrongObjective objective(part);
    const GradientCheck check = check_gradient(unknowns, objective, 3, 1);
    INFO(part << ": " << check.verdict);
    CHECK_FALSE(check.good);
    CHECK(check.verdict.find("BAD") == 0);
  }
}

TEST_CASE("Differences that scatter do not make a right gradient wrong") {
  const InverseDeck own(two);
  const Unknowns unknowns(own.deck);
  JumpyObjective objective;
  const GradientCheck check = check_gradient(unknowns, objective, 3, 1);
  INFO(check.verdict);
  CHECK(check.good);
  CHECK(check.directions[0].scatter / check.directions[0].size > 1e-5);
}

TEST_CASE("A jump of the loss within the differences does not make a right gradient wrong") {
  const InverseDeck own(two);
  const Unknowns unknowns(own.deck);
  JumpObjective objective;
  const GradientCheck check = check_gradient(unknowns, objective, 3, 1);
  INFO(check.verdict);
  CHECK(check.good);
  CHECK(check.variables[0].fine);
  CHECK_FALSE(check.variables[1].fine);
  CHECK(check.verdict.find("agree with differences over the finest steps only") != std::string::npos);
}

TEST_CASE("At a bound the check looks inwards") {
  const InverseDeck own(R"("unknowns": [ { "path": "/gravity/0", "start": 4, "bounds": [-4, 4] }, { "path": "/gravity/1" } ])");
  const Unknowns unknowns(own.deck);
  GravityObjective objective;
  const GradientCheck check = check_gradient(unknowns, objective, 4, 3);
  INFO(check.verdict);
  CHECK(check.good);
  for (const DirectionCheck& one : check.directions) CHECK(one.slope == Approx(2).margin(0.1));
}

TEST_CASE("Branches that are crossed are told, and the gradient of the one taken is right") {
  const InverseDeck own(R"("unknowns": [ { "path": "/gravity/*" } ])");
  const Unknowns unknowns(own.deck);
  BentObjective objective;
  const GradientCheck check = check_gradient(unknowns, objective, 3, 1);
  INFO(check.verdict);
  CHECK(check.good);
}
