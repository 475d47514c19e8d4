#pragma once
// Derivatives of a law's constants by the numbers of the deck's material.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "materials/registry.hpp"

namespace jaxmpm {

/// The numbers of a material that a deck gives, by key.
using MaterialNumbers = std::vector<std::pair<std::string, const double*>>;
inline MaterialNumbers material_numbers(const deck::Newtonian& m) {
  MaterialNumbers numbers{{"density", &m.density}, {"sound_speed", &m.sound_speed}, {"viscosity", &m.viscosity}};
  if (m.tension_limit) numbers.emplace_back("tension_limit", &*m.tension_limit);
  return numbers;
}
inline MaterialNumbers material_numbers(const deck::DruckerPrager& m) {
  MaterialNumbers numbers{{"density", &m.density},
                          {"friction_angle", &m.friction_angle},
                          {"dilation_angle", &m.dilation_angle},
                          {"cohesion", &m.cohesion},
                          {"tension_cutoff", &m.tension_cutoff}};
  if (m.bulk_modulus) numbers.emplace_back("bulk_modulus", &*m.bulk_modulus);
  if (m.youngs_modulus) numbers.emplace_back("youngs_modulus", &*m.youngs_modulus);
  if (m.poisson_ratio) numbers.emplace_back("poisson_ratio", &*m.poisson_ratio);
  return numbers;
}
template <class Solid>
MaterialNumbers material_numbers(const Solid& m) {
  return {{"density", &m.density}, {"youngs_modulus", &m.youngs_modulus}, {"poisson_ratio", &m.poisson_ratio}};
}

/// Σ_k by_constants[k] ∂(constant k)/∂(number) for each number of the material: from derivatives by the constants of its law (in the order
/// of Law::constants) to those by the deck's keys, exact.
std::map<std::string, double> by_material_numbers(const deck::Material& material, const double* by_constants);

}  // namespace jaxmpm
