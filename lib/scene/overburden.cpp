#include "scene/overburden.hpp"

#include <cmath>

#include "core/error.hpp"
#include "materials/elastic.hpp"

namespace jaxmpm {
namespace {

using Kind = deck::InitialStress::Kind;

double lateral_ratio(const deck::InitialStress& stress, double poisson_ratio) {
  if (stress.kind == Kind::k0) return stress.k0;
  if (stress.kind == Kind::hydrostatic) return 1;
  return poisson_ratio / (1 - poisson_ratio);  // K0 of an elastic body that cannot spread
}

}  // namespace

double Overburden::pressure(double above, double depth, double g) const {
  if (compliance == 0) return above + density * g * depth;
  return above + (above + 1 / compliance) * std::expm1(density * g * compliance * depth);
}

double reference_density(const deck::Material& material) {
  return std::visit([](const auto& m) { return m.density; }, material);
}

Overburden make_overburden(const deck::Material& material, const deck::InitialStress& stress, const std::string& pointer) {
  Overburden law;
  law.density = reference_density(material);
  if (stress.kind == Kind::none) return law;
  if (std::holds_alternative<deck::Newtonian>(material) && stress.kind != Kind::hydrostatic)
    throw DeckError(pointer, "a fluid has the same pressure in all directions; use \"hydrostatic\", or a solid material");
  const ElasticModuli moduli = elastic_moduli(material);
  law.lateral_ratio = lateral_ratio(stress, moduli.poisson_ratio());
  law.compliance = (1 + 2 * law.lateral_ratio) / (3 * moduli.bulk);
  return law;
}

}  // namespace jaxmpm
