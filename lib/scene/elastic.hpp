#pragma once
// Elastic constants of a solid material, whichever pair the deck gives.
#include "deck/deck.hpp"

namespace jaxmpm {

struct ElasticConstants {
  double bulk;   // K, Pa
  double shear;  // G, Pa
  /// ν = (3K − 2G) / (2 (3K + G))
  double poisson_ratio() const { return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)); }
};

/// From Young's modulus and Poisson's ratio: K = E / (3 (1 − 2ν)), G = E / (2 (1 + ν)).
inline ElasticConstants elastic_constants(double youngs_modulus, double poisson_ratio) {
  return {youngs_modulus / (3 * (1 - 2 * poisson_ratio)), youngs_modulus / (2 * (1 + poisson_ratio))};
}

inline ElasticConstants elastic_constants(const deck::LinearElastic& m) { return elastic_constants(m.youngs_modulus, m.poisson_ratio); }
inline ElasticConstants elastic_constants(const deck::NeoHookean& m) { return elastic_constants(m.youngs_modulus, m.poisson_ratio); }

/// Exactly two of K, E, ν are given (the deck's reader sees to it): with K and E, G = 3KE / (9K − E); with K and ν, G = 3K (1 − 2ν) / (2 (1
/// + ν)).
inline ElasticConstants elastic_constants(const deck::DruckerPrager& m) {
  if (!m.bulk_modulus) return elastic_constants(*m.youngs_modulus, *m.poisson_ratio);
  const double K = *m.bulk_modulus;
  if (m.youngs_modulus) return {K, 3 * K * *m.youngs_modulus / (9 * K - *m.youngs_modulus)};
  return {K, 3 * K * (1 - 2 * *m.poisson_ratio) / (2 * (1 + *m.poisson_ratio))};
}

}  // namespace jaxmpm
