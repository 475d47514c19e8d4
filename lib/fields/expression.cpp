#include "fields/expression.hpp"

#include <muParser.h>

#include <cmath>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

std::string valid_names(int dim, const std::map<std::string, double>& parameters) {
  std::string names = dim == 3 ? "x, y, z" : "x, y";
  for (const auto& parameter : parameters) names += ", " + parameter.first;
  return names;
}

/// muparser would let a formula overwrite its variables: "=" other than in ==, !=, <= and >=.
bool assigns(const std::string& text) {
  for (std::size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    if (at + 1 < text.size() && text[at + 1] == '=') ++at;
    else if (at == 0 || std::string("!<>").find(text[at - 1]) == std::string::npos) return true;
  }
  return false;
}

}  // namespace

struct Expression::Parser {
  mu::Parser parser;
  std::array<double, 3> place{};
};

Expression::Expression(const std::string& text, int dim, const std::map<std::string, double>& parameters, const std::string& pointer)
    : parser_(std::make_unique<Parser>()), text_(text), pointer_(pointer) {
  if (assigns(text)) throw DeckError(pointer, "the expression \"" + text + "\" assigns to a name; give a value, and == to compare");
  for (const auto& parameter : parameters)
    if (coordinate_index(parameter.first, dim) >= 0)
      throw DeckError("/parameters/" + parameter.first, "a parameter may not be called like a coordinate; choose another name");
  std::map<std::string, double> values = parameters;
  try {
    for (int d = 0; d < dim; ++d) parser_->parser.DefineVar(std::string(1, "xyz"[d]), &parser_->place[d]);
    for (auto& parameter : values) parser_->parser.DefineVar(parameter.first, &parameter.second);
    parser_->parser.SetExpr(text);
    for (const auto& variable : parser_->parser.GetUsedVar())
      if (coordinate_index(variable.first, dim) < 0) {
        if (parameters.count(variable.first) == 0)
          throw DeckError(pointer, "unknown name '" + variable.first + "' in the expression \"" + text + "\"; valid names are " +
                                       valid_names(dim, parameters));
        used_.push_back(variable.first);
      }
    // Parameters are constants of a run: muparser then folds them.
    for (const auto& parameter : parameters) {
      parser_->parser.RemoveVar(parameter.first);
      parser_->parser.DefineConst(parameter.first, parameter.second);
    }
    parser_->parser.Eval();
    if (parser_->parser.GetNumResults() != 1) throw DeckError(pointer, "the expression \"" + text + "\" has several values; give one");
  } catch (const mu::Parser::exception_type& error) {
    throw DeckError(pointer, "the expression \"" + text + "\" cannot be read: " + error.GetMsg() + " Valid names are " +
                                 valid_names(dim, parameters) +
                                 "; functions are sin, cos, tan, exp, ln, sqrt, abs, min, max and their like");
  }
}

Expression::~Expression() = default;

double Expression::value(const std::array<double, 3>& place) const {
  parser_->place = place;
  return parser_->parser.Eval();
}

}  // namespace jaxmpm
