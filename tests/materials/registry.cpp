// What every law must do alike: be found by its deck material, and give the same numbers on packs of lanes and dual numbers as on doubles.
#include "core/pack.hpp"
#include "drive.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace jaxmpm::test {
namespace {

std::vector<deck::Material> every_material() {
  deck::DruckerPrager sand;
  sand.density = 2650, sand.bulk_modulus = 7e5, sand.poisson_ratio = 0.3, sand.friction_angle = 30, sand.dilation_angle = 5,
  sand.cohesion = 100;
  return {deck::Newtonian{1000, 35, 0, 0.0}, deck::Newtonian{1000, 35, 2, {}}, sand, deck::LinearElastic{1200, 1e6, 0.3},
          deck::NeoHookean{1100, 1e5, 0.2}};
}

TEST_CASE("registry: each material of a deck gets its law, an inviscid fluid one without history") {
  std::vector<int> sizes, plastic;
  for (const deck::Material& material : every_material())
    with_law<double>(material, [&](const auto& law) {
      using Law = std::decay_t<decltype(law)>;
      sizes.push_back(Law::template history_size<3>());
      plastic.push_back(Law::template plastic_strain_index<2>());
    });
  CHECK(sizes == std::vector<int>{0, 6, 7, 6, 9});
  CHECK(plastic == std::vector<int>{-1, -1, 4, -1, -1});
}

/// Everything that a law says of a point after three increments: stress, history, compression, dissipation, energy, wave speed.
template <class Real, int Dim, class Law>
std::vector<Real> answers(const Law& law, const std::vector<Matrix<Real, Dim>>& increments) {
  MaterialPoint<Law, Dim, Real> point(law);
  Symmetric<Real, Dim> first{};
  for (int k = 0; k < 3; ++k) first[k] = Real(-1000);
  point.start(first);
  for (const Matrix<Real, Dim>& H : increments) point.advance(H, Real(1e-3));
  std::vector<Real> all = point.history;
  const Symmetric<Real, Dim> s = point.stress();
  all.insert(all.end(), s.a, s.a + s.size);
  for (const Real& x : {point.compression, point.dissipated, point.energy(), point.wave_speed()}) all.push_back(x);
  return all;
}

template <class T, int Dim>
void compare_with_lanes(const deck::Material& material, double tolerance) {
  constexpr int lanes = 8;
  using Lanes = Pack<T, lanes>;
  std::mt19937_64 random(17);
  std::uniform_real_distribution<T> uniform(T(-0.01), T(0.01));
  std::vector<Matrix<Lanes, Dim>> packed(3);
  std::vector<std::vector<Matrix<T, Dim>>> single(lanes, std::vector<Matrix<T, Dim>>(3));
  for (int step = 0; step < 3; ++step)
    for (int k = 0; k < Dim * Dim; ++k) {
      T values[lanes];
      for (int lane = 0; lane < lanes; ++lane) values[lane] = single[lane][step].a[k] = uniform(random);
      packed[step].a[k] = Lanes::load(values);
    }
  with_law<T>(material, [&](const auto& law) {
    const std::vector<Lanes> all = answers<Lanes, Dim>(law, packed);
    for (int lane = 0; lane < lanes; ++lane) {
      const std::vector<T> one = answers<T, Dim>(law, single[lane]);
      for (std::size_t k = 0; k < one.size(); ++k) CHECK(all[k][lane] == Approx(one[k]).epsilon(tolerance).margin(tolerance));
    }
  });
}

TEST_CASE("registry: every law gives the same on packs of lanes as on one number") {
  for (const deck::Material& material : every_material()) {
    INFO("material number " << material.index());
    compare_with_lanes<double, 2>(material, 1e-11);
    compare_with_lanes<double, 3>(material, 1e-11);
    compare_with_lanes<float, 2>(material, 2e-3);
    compare_with_lanes<float, 3>(material, 2e-3);
  }
}

TEST_CASE("registry: every law gives the same value and a finite derivative on dual numbers") {
  using D = Dual<double, 1>;
  std::mt19937_64 random(18);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (const deck::Material& material : every_material())
    with_law<double>(material, [&](const auto& law) {
      std::vector<Matrix<double, 3>> plain(3);
      std::vector<Matrix<D, 3>> dual(3);
      for (int step = 0; step < 3; ++step)
        for (int k = 0; k < 9; ++k) {
          plain[step].a[k] = uniform(random);
          dual[step].a[k] = D::variable(plain[step].a[k], 0);
        }
      const std::vector<double> expected = answers<double, 3>(law, plain);
      const std::vector<D> got = answers<D, 3>(law, dual);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        CHECK(got[k].value == Approx(expected[k]).epsilon(1e-12).margin(1e-12));
        CHECK(std::isfinite(got[k].derivative[0]));
      }
    });
}

}  // namespace
}  // namespace jaxmpm::test
