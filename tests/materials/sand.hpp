#pragma once
// Drucker–Prager materials for the tests, and their appendix A once more with plain branches.
#include "drive.hpp"

namespace jaxmpm::test {

inline deck::DruckerPrager sand(double friction, double dilation, double cohesion, double cutoff, double poisson = 0.3) {
  deck::DruckerPrager m;
  m.density = 2650;
  m.bulk_modulus = 0.7e6;
  m.poisson_ratio = poisson;
  m.friction_angle = friction;
  m.dilation_angle = dilation;
  m.cohesion = cohesion;
  m.tension_cutoff = cutoff;
  return m;
}

using Sand = DruckerPrager<double>;

enum class Zone { elastic, shear, corner_from_shear, tension, corner_from_tension };
struct Expected {
  Zone zone;
  double mean, shear, plastic_strain;
};

/// Appendix A in its own words, with the repairs that theory.md lists, as if-branches.
inline Expected by_branches(const Sand& law, double mean, double shear) {
  const double q = law.friction, k = law.cohesion, st = law.tension_cutoff, K = law.elasticity.bulk, G = law.elasticity.shear;
  const double tau_P = k - q * st, alpha = std::sqrt(1 + q * q) - q, q_psi = law.dilation;
  const double fs = shear - k + q * mean, ft = mean - st;
  const bool along_return = alpha * K * q_psi > G;
  const bool above = along_return ? G * ft < K * q_psi * (shear - tau_P) : shear - tau_P - alpha * ft > 0;
  const double per_lambda = std::sqrt(1.0 / 3 + 2.0 / 9 * q_psi * q_psi);
  if (ft < 0 && fs <= 0) return {Zone::elastic, mean, shear, 0};
  if (ft < 0 || above) {
    const double lambda_s = fs / (G + K * q * q_psi), end = mean - K * q_psi * lambda_s;
    if (end > st) return {Zone::corner_from_shear, st, tau_P, lambda_s * per_lambda};
    return {Zone::shear, end, k - q * end, lambda_s * per_lambda};
  }
  const double strain = std::sqrt(2.0) / 3 * ft / K;
  if (shear > tau_P) return {Zone::corner_from_tension, st, tau_P, strain};
  return {Zone::tension, st, shear, strain};
}

/// How far a stress is outside the cone or the cut-off, Pa (not above 0 inside).
template <int Dim>
double outside(const Sand& law, const Symmetric<double, Dim>& s) {
  const double m = mean(s), shear = shear_invariant(s);
  return std::max(shear - law.cohesion + law.friction * m, m - law.tension_cutoff);
}

}  // namespace jaxmpm::test
