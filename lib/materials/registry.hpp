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

/// Calls f(law) with the law of a deck's material, its parameters of type Scalar; f returns the same type for every law. `number` reads the
/// deck's numbers (material.hpp).
template <class Scalar, class F, class Number = DeckNumber>
decltype(auto) with_law(const deck::Material& material, F&& f, const Number& number = {}) {
  return std::visit(detail::Overloaded{
                        [&](const deck::Newtonian& m) {
                          return m.viscosity == 0 ? f(InviscidFluid<Scalar>::from(m, number)) : f(ViscousFluid<Scalar>::from(m, number));
                        },
                        [&](const deck::DruckerPrager& m) { return f(DruckerPrager<Scalar>::from(m, number)); },
                        [&](const deck::LinearElastic& m) { return f(LinearElastic<Scalar>::from(m, number)); },
                        [&](const deck::NeoHookean& m) { return f(NeoHookean<Scalar>::from(m, number)); },
                    },
                    material);
}

}  // namespace jaxmpm
