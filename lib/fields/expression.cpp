#include "fields/expression.hpp"

#include <muParser.h>

#include <cmath>

#include "core/error.hpp"

namespace jaxmpm {
namespace {

constexpr const char* time_name = "t";

std::string valid_names(int dim, Expression::Of of, const std::map<std::string, double>& parameters) {
  std::string names = dim == 3 ? "x, y, z" : "x, y";
  if (of == Expression::Of::space_and_time) names += std::string(", ") + time_name;
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
  double time = 0;
};

Expression::Expression(const std::string& text, int dim, const std::map<std::string, double>& parameters, const std::string& pointer, Of of)
    : parser_(std::make_unique<Parser>()), text_(text), pointer_(pointer) {
  if (assigns(text)) throw DeckError(pointer, "the expression \"" + text + "\" assigns to a name; give a value, and == to compare");
  const auto is_variable = [&](const std::string& name) {
    return coordinate_index(name, dim) >= 0 || (of == Of::space_and_time && name == time_name);
  };
  for (const auto& parameter : parameters)
    if (is_variable(parameter.first))
      throw DeckError("/parameters/" + parameter.first, "a parameter may not be called like a coordinate; choose another name");
  std::map<std::string, double> values = parameters;
  try {
    for (int d = 0; d < dim; ++d) parser_->parser.DefineVar(std::string(1, "xyz"[d]), &parser_->place[d]);
    if (of == Of::space_and_time) parser_->parser.DefineVar(time_name, &parser_->time);
    for (auto& parameter : values) parser_->parser.DefineVar(parameter.first, &parameter.second);
    parser_->parser.SetExpr(text);
    for (const auto& variable : parser_->parser.GetUsedVar())
      if (!is_variable(variable.first)) {
        if (parameters.count(variable.first) == 0)
          throw DeckError(pointer, "unknown name '" + variable.first + "' in the expression \"" + text + "\"; valid names are " +
                                       valid_names(dim, of, parameters));
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
                                 valid_names(dim, of, parameters) +
                                 "; functions are sin, cos, tan, exp, ln, sqrt, abs, min, max and their like");
  }
}

Expression::~Expression() = default;

double Expression::value(const std::array<double, 3>& place) const { return value(place, 0); }

double Expression::value(const std::array<double, 3>& place, double time) const {
  parser_->place = place, parser_->time = time;
  return parser_->parser.Eval();
}

}  // namespace jaxmpm
