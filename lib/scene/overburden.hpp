#pragma once
// How vertical pressure grows with depth in one body.
#include <string>

#include "deck/deck.hpp"

namespace jaxmpm {

/// Law of one body (see scene/initial_stress.hpp). Pressures in Pa, positive in compression.
struct Overburden {
  double density = 0;        // ρ0, kg/m³
  double compliance = 0;     // m/K, 1/Pa; 0 where the weight is taken at ρ0
  double lateral_ratio = 1;  // k: lateral over vertical pressure

  /// Vertical pressure at a depth (m) below a place where it is `above`, under gravity g (m/s²).
  double pressure(double above, double depth, double g) const;
  /// ρ/ρ0 − 1 under a vertical pressure.
  double compression(double vertical) const { return compliance * vertical; }
};

/// `pointer`: /bodies/i/initial_stress. DeckError where the kind does not suit the material.
Overburden make_overburden(const deck::Material& material, const deck::InitialStress& stress, const std::string& pointer);

/// ρ0 of any material.
double reference_density(const deck::Material& material);

}  // namespace jaxmpm
