#pragma once
// The materials that there are: from a deck's material to its law, one line each.
#include <utility>
#include <variant>

#include "materials/drucker_prager.hpp"
#include "materials/linear_elastic.hpp"
#include "materials/neo_hookean.hpp"
#include "materials/newtonian.hpp"

namespace jaxmpm {

namespace detail {
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;
}  // namespace detail

/// Calls f(law) with the law of a deck's material, its parameters of type Scalar; f returns the same type for every law.
template <class Scalar, class F>
decltype(auto) with_law(const deck::Material& material, F&& f) {
  return std::visit(
      detail::Overloaded{
          [&](const deck::Newtonian& m) { return m.viscosity == 0 ? f(InviscidFluid<Scalar>::from(m)) : f(ViscousFluid<Scalar>::from(m)); },
          [&](const deck::DruckerPrager& m) { return f(DruckerPrager<Scalar>::from(m)); },
          [&](const deck::LinearElastic& m) { return f(LinearElastic<Scalar>::from(m)); },
          [&](const deck::NeoHookean& m) { return f(NeoHookean<Scalar>::from(m)); },
      },
      material);
}

}  // namespace jaxmpm
