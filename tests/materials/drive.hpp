#pragma once
// Drives one material point of a law through increments, for the tests of the laws.
#include <algorithm>
#include <vector>

#include "core/dual.hpp"
#include "materials/registry.hpp"

namespace jaxmpm::test {

template <class Law, int Dim, class Real = double>
struct MaterialPoint {
  Law law;
  Real compression{};
  std::vector<Real> history = std::vector<Real>(Law::template history_size<Dim>(), Real(0));
  Real dissipated{};  // summed, J/m³

  explicit MaterialPoint(const Law& of) : law(of) {}

  void start(const Symmetric<Real, Dim>& stress) { law.template start<Real, Dim>(stress, compression, history.data()); }
  void advance(const Matrix<Real, Dim>& H, Real dt = Real(1)) {
    dissipated = dissipated + law.template update<Real, Dim>(H, dt, compression, history.data());
  }
  Symmetric<Real, Dim> stress() const { return law.template stress<Real, Dim>(compression, history.data()); }
  Real energy() const { return law.template energy<Real, Dim>(compression, history.data()); }
  Real wave_speed() const { return law.template wave_speed<Real, Dim>(compression, history.data()); }
  Real plastic_strain() const { return history[Law::template plastic_strain_index<Dim>()]; }
};

template <class Real, int Dim>
Real shear_invariant(const Symmetric<Real, Dim>& s) {
  return sqrt(half_square(deviator(s)));
}

inline Matrix<double, 3> diagonal(double xx, double yy, double zz) { return {{xx, 0, 0, 0, yy, 0, 0, 0, zz}}; }
inline Matrix<double, 2> diagonal(double xx, double yy) { return {{xx, 0, 0, yy}}; }

/// The work rate identity of a law that stores all its work: d(ψ V)/dH = V σ at H = 0, with V ∝ 1/(1 + e). Returns the largest error of a
/// component relative to `scale`.
template <int Dim, class Law>
double work_error(const MaterialPoint<Law, Dim>& point, double scale) {
  using D = Dual<double, Dim * Dim>;
  Matrix<D, Dim> H;
  for (int k = 0; k < Dim * Dim; ++k) H.a[k] = D::variable(0, k);
  D compression(point.compression);
  std::vector<D> history(point.history.begin(), point.history.end());
  point.law.template update<D, Dim>(H, D(1), compression, history.data());
  const D work = point.law.template energy<D, Dim>(compression, history.data()) * D(1 + point.compression) / (D(1) + compression);
  const Symmetric<double, Dim> sigma = point.stress();
  double worst = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) worst = std::max(worst, std::abs(work.derivative[i * Dim + j] - sigma(i, j)) / scale);
  return worst;
}

}  // namespace jaxmpm::test
