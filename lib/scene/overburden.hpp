#pragma once
// How vertical pressure grows with depth in one body.
#include <string>

#include "core/error.hpp"
#include "deck/deck.hpp"
#include "materials/elastic.hpp"

namespace jaxmpm {

/// Law of one body (see scene/initial_stress.hpp), of doubles or dual numbers. Pressures in Pa, positive in compression.
template <class Real = double>
struct Overburden {
  Real density{};         // ρ0, kg/m³
  Real compliance{};      // m/K, 1/Pa; 0 where the weight is taken at ρ0
  Real lateral_ratio{1};  // k: lateral over vertical pressure

  /// Vertical pressure at a depth (m) below a place where it is `above`, under gravity g (m/s²).
  Real pressure(const Real& above, const Real& depth, const Real& g) const {
    if (compliance == Real(0)) return above + density * g * depth;
    return above + (above + Real(1) / compliance) * expm1(density * g * compliance * depth);
  }
  /// ρ/ρ0 − 1 under a vertical pressure.
  Real compression(const Real& vertical) const { return compliance * vertical; }
};

/// `pointer`: /bodies/i/initial_stress. DeckError where the kind does not suit the material. `number` reads the deck's numbers (see
/// materials/material.hpp).
template <class Number = DeckNumber>
auto make_overburden(const deck::Material& material, const deck::InitialStress& stress, const std::string& pointer,
                     const Number& number = {}) {
  using Kind = deck::InitialStress::Kind;
  using Real = decltype(number(stress.k0));
  Overburden<Real> law;
  law.density = std::visit([&](const auto& m) { return number(m.density); }, material);
  if (stress.kind == Kind::none) return law;
  if (std::holds_alternative<deck::Newtonian>(material) && stress.kind != Kind::hydrostatic)
    throw DeckError(pointer, "a fluid has the same pressure in all directions; use \"hydrostatic\", or a solid material");
  const ElasticModuli<Real> moduli = elastic_moduli(material, number);
  if (stress.kind == Kind::k0) law.lateral_ratio = number(stress.k0);
  if (stress.kind == Kind::geostatic) {  // K0 of an elastic body that cannot spread
    const Real poisson = moduli.poisson_ratio();
    law.lateral_ratio = poisson / (Real(1) - poisson);
  }
  law.compliance = (Real(1) + Real(2) * law.lateral_ratio) / (Real(3) * moduli.bulk);
  return law;
}

}  // namespace jaxmpm
