#pragma once
// Derivative of an expression by one of its names, as another expression: GiNaC differentiates what muparser evaluates.
#include <string>

namespace jaxmpm {

/// Text of ∂(text)/∂(name), in muparser's language. `text` is an expression that muparser reads. Of a condition c ? a : b each branch is
/// differentiated as taken. DeckError at `pointer`, naming the function or operator, where one that has no derivative (abs, min, max, sign,
/// rint, a comparison …) is applied to what depends on `name`; elsewhere it is a factor like any other.
std::string derivative_text(const std::string& text, const std::string& name, const std::string& pointer);

}  // namespace jaxmpm
