// What is left between data and the best run: noise, or something that the model leaves out.
#include "inverse/misfit.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace jaxmpm;

namespace {

/// Data of three subjects at `times` times, two numbers each, from which a run differs by difference(subject, time, k).
template <class F>
Comparison compared(std::size_t times, F&& difference) {
  Comparison c;
  c.width = 2;
  for (std::size_t t = 0; t < times; ++t)
    for (std::size_t subject = 0; subject < 3; ++subject) {
      c.time.push_back(0.1 * double(t)), c.subject.push_back(subject), c.sigma.push_back(1);
      for (std::size_t k = 0; k < 2; ++k) {
        c.observed.push_back(double(subject) + std::sin(double(t)));
        c.read.push_back(c.observed.back() + difference(subject, t, k));
      }
    }
  return c;
}

}  // namespace

TEST_CASE("independent differences are noise, ones that go on from time to time are not") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Misfit noise = misfit_of(compared(100, [&](auto...) { return 0.01 * normal(random); }));
  CHECK(noise.pairs == 99 * 3 * 2);
  CHECK(std::abs(noise.correlation) < 3 / std::sqrt(double(noise.pairs)));
  CHECK_FALSE(noise.is_no_noise());
  const auto wave = [](std::size_t subject, std::size_t t, std::size_t) { return 0.01 * std::sin(0.2 * double(t + subject)); };
  const Misfit missed = misfit_of(compared(100, wave));
  CHECK(missed.correlation == Approx(std::cos(0.2)).margin(0.01));
  CHECK(missed.is_no_noise());
  const Misfit both = misfit_of(
      compared(100, [&](std::size_t subject, std::size_t t, std::size_t k) { return wave(subject, t, k) + 0.002 * normal(random); }));
  CHECK(both.is_no_noise());
}

TEST_CASE("differences that are too few, all zero or a trace tell nothing") {
  const Misfit few = misfit_of(compared(2, [](auto...) { return 0.5; }));
  CHECK(few.pairs == 6);
  CHECK(few.correlation == Approx(1));
  CHECK_FALSE(few.can_tell());
  const Misfit equal = misfit_of(compared(50, [](auto...) { return 0.0; }));
  CHECK(std::isnan(equal.correlation));
  CHECK_FALSE(equal.can_tell());
  CHECK_FALSE(misfit_of(compared(50, [](auto...) { return 1e-6; })).can_tell());
  const Misfit once = misfit_of(compared(1, [](auto...) { return 0.5; }));  // subjects that are no places have no neighbours
  CHECK(once.pairs == 0);
}

TEST_CASE("neighbours of a profile at one time are its places, and what could not be read has none") {
  Comparison c;
  c.width = 1;
  for (std::size_t place = 0; place < 30; ++place) {
    c.time.push_back(1), c.subject.push_back(place), c.sigma.push_back(1), c.places.push_back({double(place)});
    c.observed.push_back(std::cos(0.1 * double(place))), c.read.push_back(c.observed.back() + 0.1);
  }
  CHECK(misfit_of(c).pairs == 29);
  CHECK(misfit_of(c).is_no_noise());
  c.read[10] = std::nan("");
  const Misfit gap = misfit_of(c);
  CHECK(gap.pairs == 27);
  CHECK(gap.unread == 1);
  CHECK(gap.rms == Approx(0.1));
}
