// The adjoints that laws write by hand against the tape of their forward update, over random states on all branches.
#include "kernels/adjoint/material_adjoint_impl.hpp"

#include <catch2/catch.hpp>
#include <random>

using namespace jaxmpm;

namespace {

template <int Dim>
Particles<double, Dim> random_particles(std::size_t n, std::size_t history, double stress, double compression, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto fill = [&](double scale) {
    Array<double> a(n);
    for (double& x : a) x = scale * normal(random);
    return a;
  };
  Particles<double, Dim> p;
  p.compression = fill(compression), p.mass = fill(1);
  for (std::size_t k = 0; k < history; ++k) p.history.push_back(fill(stress));
  return p;
}

void check_equal(const Array<double>& a, const Array<double>& b) {
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(std::isfinite(a[i]));
    largest = std::max(largest, std::abs(b[i])), difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  CHECK(difference <= 1e-12 * largest);
}

template <int Dim, template <class> class Law>
void compare(const Law<double>& law, double stress, double strain) {
  constexpr int W = native_lanes<double>;
  constexpr std::size_t history = std::size_t(Law<double>::template history_size<Dim>());
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const LawAdjoint<double, Dim, Law> adjoint(law);
  for (int round = 0; round < 200; ++round) {
    const int count = round % 3 == 0 ? W : 1 + round % W;
    const auto p = random_particles<Dim>(std::size_t(count), history, stress, strain, random);
    auto by_hand = random_particles<Dim>(std::size_t(count), history, 1 / stress, 1, random), by_tape = by_hand;
    alignas(64) double H[Dim * Dim][W] = {}, hand_H[Dim * Dim][W], tape_H[Dim * Dim][W], by_sigma[6][W] = {};
    for (auto& component : H)
      for (int l = 0; l < count; ++l) component[l] = strain * normal(random);
    for (auto& component : by_sigma)
      for (int l = 0; l < count; ++l) component[l] = normal(random) / stress;
    MaterialReport hand, tape;
    ParticleView<double, Dim> into_hand(by_hand), into_tape(by_tape);
    adjoint.update(p, 0, count, H, 1e-3, into_hand, hand_H, hand);
    adjoint.update_by_tape(p, 0, count, H, 1e-3, into_tape, tape_H, tape);
    adjoint.stress(p, 0, count, by_sigma, into_hand, hand);
    adjoint.stress_by_tape(p, 0, count, by_sigma, into_tape, tape);
    check_equal(by_hand.compression, by_tape.compression);
    for (std::size_t k = 0; k < history; ++k) check_equal(by_hand.history[k], by_tape.history[k]);
    for (int k = 0; k < Dim * Dim; ++k)
      check_equal(Array<double>(hand_H[k], hand_H[k] + count), Array<double>(tape_H[k], tape_H[k] + count));
    for (std::size_t k = 0; k < hand.constants.size(); ++k)
      CHECK(std::abs(hand.constants[k] - tape.constants[k]) <= 1e-11 * (std::abs(tape.constants[k]) + 1e-3));
    CHECK((hand.at_kinks > 0) == (tape.at_kinks > 0));
  }
}

template <int Dim>
void compare_all() {
  deck::Newtonian water;
  water.density = 1000, water.sound_speed = 20, water.viscosity = 2, water.tension_limit = 50;
  compare<Dim, InviscidFluid>(InviscidFluid<double>::from(water), 100, 1e-3);
  compare<Dim, ViscousFluid>(ViscousFluid<double>::from(water), 100, 1e-3);
  deck::LinearElastic elastic;
  elastic.density = 1500, elastic.youngs_modulus = 1e5, elastic.poisson_ratio = 0.3;
  compare<Dim, LinearElastic>(LinearElastic<double>::from(elastic), 1e4, 0.1);
  compare<Dim, NeoHookean>(NeoHookean<double>::from(deck::NeoHookean{1000, 1e5, 0.3}), 0.1, 0.1);  // its history is a strain
  for (const double dilation : {0.0, 5.0, 30.0}) {  // the last turns the border of the tension zone
    deck::DruckerPrager sand;
    sand.density = 2000, sand.friction_angle = 30, sand.dilation_angle = dilation, sand.cohesion = 100, sand.tension_cutoff = 40;
    sand.bulk_modulus = 1e5, sand.poisson_ratio = dilation > 10 ? 0.45 : 0.3;
    compare<Dim, DruckerPrager>(DruckerPrager<double>::from(sand), 300, 2e-3);
  }
}

}  // namespace

TEST_CASE("adjoints by hand equal those of the tape, 2D") { compare_all<2>(); }
TEST_CASE("adjoints by hand equal those of the tape, 3D") { compare_all<3>(); }
