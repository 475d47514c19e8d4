#include "scene/overburden.hpp"

#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "scene/elastic.hpp"

namespace jaxmpm {
namespace {

using Kind = deck::InitialStress::Kind;

/// Constants of a solid; none for a fluid.
std::optional<ElasticConstants> solid_constants(const deck::Material& material) {
  return std::visit(
      [](const auto& m) -> std::optional<ElasticConstants> {
        if constexpr (std::is_same_v<std::decay_t<decltype(m)>, deck::Newtonian>) return std::nullopt;
        else return elastic_constants(m);
      },
      material);
}

double lateral_ratio(const deck::InitialStress& stress, const ElasticConstants& constants) {
  if (stress.kind == Kind::k0) return stress.k0;
  if (stress.kind == Kind::hydrostatic) return 1;
  const double nu = constants.poisson_ratio();
  return nu / (1 - nu);  // K0 of an elastic body that cannot spread
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
  if (const auto* fluid = std::get_if<deck::Newtonian>(&material)) {
    if (stress.kind != Kind::hydrostatic)
      throw DeckError(pointer, "a fluid has the same pressure in all directions; use \"hydrostatic\", or a solid material");
    law.compliance = 1 / (fluid->density * fluid->sound_speed * fluid->sound_speed);
    return law;
  }
  const ElasticConstants constants = *solid_constants(material);
  law.lateral_ratio = lateral_ratio(stress, constants);
  law.compliance = (1 + 2 * law.lateral_ratio) / (3 * constants.bulk);
  return law;
}

}  // namespace jaxmpm
