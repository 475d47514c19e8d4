#include "fields/expression_derivative.hpp"

#include <ginac/ginac.h>

#include <cctype>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "core/error.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

using GiNaC::ex;

std::string number_of(const GiNaC::numeric& value) {
  std::ostringstream stream;
  stream.precision(17);
  stream << value.to_double();
  return "(" + stream.str() + ")";
}

/// GiNaC's trees as muparser writes them, fully in brackets. Names stand for themselves: also those that stand for a piece of text.
std::string text_of(const ex& e) {
  if (GiNaC::is_a<GiNaC::numeric>(e)) return number_of(GiNaC::ex_to<GiNaC::numeric>(e));
  if (GiNaC::is_a<GiNaC::symbol>(e)) return GiNaC::ex_to<GiNaC::symbol>(e).get_name();
  if (GiNaC::is_a<GiNaC::constant>(e)) return number_of(GiNaC::ex_to<GiNaC::numeric>(e.evalf()));
  if (GiNaC::is_a<GiNaC::power>(e)) return "(" + text_of(e.op(0)) + ")^(" + text_of(e.op(1)) + ")";
  std::string separator = GiNaC::is_a<GiNaC::add>(e) ? "+" : GiNaC::is_a<GiNaC::mul>(e) ? "*" : ",", inner;
  for (std::size_t i = 0; i < e.nops(); ++i) inner += (i > 0 ? separator : "") + text_of(e.op(i));
  const bool function = GiNaC::is_a<GiNaC::function>(e);
  const std::string name = function ? GiNaC::ex_to<GiNaC::function>(e).get_name() : "";
  return (name == "log" ? "ln" : name) + "(" + inner + ")";
}

/// The smooth functions of muparser.
const std::map<std::string, ex (*)(const ex&)>& smooth_functions() {
  static const std::map<std::string, ex (*)(const ex&)> functions{
      {"sin", [](const ex& a) -> ex { return GiNaC::sin(a); }},
      {"cos", [](const ex& a) -> ex { return GiNaC::cos(a); }},
      {"tan", [](const ex& a) -> ex { return GiNaC::tan(a); }},
      {"asin", [](const ex& a) -> ex { return GiNaC::asin(a); }},
      {"acos", [](const ex& a) -> ex { return GiNaC::acos(a); }},
      {"atan", [](const ex& a) -> ex { return GiNaC::atan(a); }},
      {"sinh", [](const ex& a) -> ex { return GiNaC::sinh(a); }},
      {"cosh", [](const ex& a) -> ex { return GiNaC::cosh(a); }},
      {"tanh", [](const ex& a) -> ex { return GiNaC::tanh(a); }},
      {"asinh", [](const ex& a) -> ex { return GiNaC::asinh(a); }},
      {"acosh", [](const ex& a) -> ex { return GiNaC::acosh(a); }},
      {"atanh", [](const ex& a) -> ex { return GiNaC::atanh(a); }},
      {"exp", [](const ex& a) -> ex { return GiNaC::exp(a); }},
      {"ln", [](const ex& a) -> ex { return GiNaC::log(a); }},
      {"log", [](const ex& a) -> ex { return GiNaC::log(a); }},
      {"log2", [](const ex& a) -> ex { return GiNaC::log(a) / GiNaC::log(ex(2)); }},
      {"log10", [](const ex& a) -> ex { return GiNaC::log(a) / GiNaC::log(ex(10)); }},
      {"sqrt", [](const ex& a) -> ex { return GiNaC::sqrt(a); }}};
  return functions;
}

/// Reads muparser's grammar (lowest first: ?: right to left, ||, &&, comparisons, + −, * /, signs, ^ right to left) into GiNaC's trees.
/// What GiNaC has no word for becomes a symbol that stands for its text, if it does not depend on the name, or that has a derivative of its
/// own.
class Differentiator {
 public:
  Differentiator(const std::string& text, const std::string& name, const std::string& pointer)
      : text_(text), pointer_(pointer), name_(symbol(name)) {}

  std::string derivative() {
    const ex whole = condition();
    if (!next().empty()) fail("is not understood from '" + text_.substr(at_) + "' on");
    return written(total(whole));
  }

 private:
  /// d/d(name), through the conditions within too.
  ex total(const ex& e) const {
    ex sum = e.diff(name_);
    for (const auto& [condition, slope] : slopes_)
      if (e.has(condition)) sum += e.diff(condition) * slope;
    return sum;
  }
  bool depends(const ex& e) const {
    if (e.has(name_)) return true;
    for (const auto& [condition, slope] : slopes_)
      if (e.has(condition)) return true;
    return false;
  }

  ex condition() {
    ex left = logical_or();
    if (next() != "?") return left;
    take("?");
    refuse_dependent({left}, "?");
    const ex yes = condition();
    take(":");
    const ex no = condition();
    const ex whole = piece("(" + written(left) + "?" + written(yes) + ":" + written(no) + ")");
    if (depends(yes) || depends(no))
      slopes_.emplace_back(GiNaC::ex_to<GiNaC::symbol>(whole),
                           piece("(" + written(left) + "?" + written(total(yes)) + ":" + written(total(no)) + ")"));
    return whole;
  }
  ex logical_or() {
    ex left = logical_and();
    while (next() == "||") {
      take("||");
      left = no_derivative("||", left, logical_and());
    }
    return left;
  }
  ex logical_and() {
    ex left = comparison();
    while (next() == "&&") {
      take("&&");
      left = no_derivative("&&", left, comparison());
    }
    return left;
  }
  ex comparison() {
    ex left = sum();
    for (std::string op = next(); op == "<" || op == ">" || op == "<=" || op == ">=" || op == "==" || op == "!="; op = next()) {
      take(op);
      left = no_derivative(op, left, sum());
    }
    return left;
  }
  ex sum() {
    ex left = product();
    for (std::string op = next(); op == "+" || op == "-"; op = next()) {
      take(op);
      left = op == "+" ? ex(left + product()) : ex(left - product());
    }
    return left;
  }
  ex product() {
    ex left = sign();
    for (std::string op = next(); op == "*" || op == "/"; op = next()) {
      take(op);
      left = op == "*" ? ex(left * sign()) : ex(left / sign());
    }
    return left;
  }
  ex sign() {
    const std::string op = next();
    if (op != "-" && op != "+") return power();
    take(op);
    return op == "-" ? ex(-sign()) : sign();
  }
  ex power() {
    const ex base = primary();
    if (next() != "^") return base;
    take("^");
    return GiNaC::pow(base, sign());
  }
  ex primary() {
    const std::string token = next();
    if (token == "(") {
      take("(");
      const ex inner = condition();
      take(")");
      return inner;
    }
    if (token.empty() || (std::isalnum(static_cast<unsigned char>(token[0])) == 0 && token[0] != '_' && token[0] != '.'))
      fail("is not understood at '" + text_.substr(at_) + "'");
    take(token);
    double value = 0;
    if (parse_number(token, value))  // whole ones exactly, so that GiNaC can reduce powers
      return std::abs(value) < 1e9 && value == std::floor(value) ? GiNaC::numeric(static_cast<long>(value)) : GiNaC::numeric(value);
    if (next() == "(") return call(token);
    if (token == "_pi") return GiNaC::numeric(M_PI);
    if (token == "_e") return GiNaC::numeric(M_E);
    return symbol(token);
  }
  ex call(const std::string& function) {
    std::vector<ex> arguments;
    for (take("("); arguments.empty() || next() == ","; arguments.push_back(condition()))
      if (!arguments.empty()) take(",");
    take(")");
    const auto smooth = smooth_functions().find(function);
    if (smooth != smooth_functions().end() && arguments.size() == 1) return smooth->second(arguments[0]);
    if (function == "atan2" && arguments.size() == 2) return GiNaC::atan2(arguments[0], arguments[1]);
    if (function == "sum" || function == "avg") {
      ex sum = 0;
      for (const ex& argument : arguments) sum += argument;
      return function == "sum" ? sum : ex(sum / static_cast<long>(arguments.size()));
    }
    refuse_dependent(arguments, function);
    std::string inner;
    for (const ex& argument : arguments) inner += (inner.empty() ? "" : ",") + written(argument);
    return piece(function + "(" + inner + ")");
  }

  ex no_derivative(const std::string& op, const ex& left, const ex& right) {
    refuse_dependent({left, right}, op);
    return piece("(" + written(left) + op + written(right) + ")");
  }
  void refuse_dependent(const std::vector<ex>& arguments, const std::string& function) const {
    for (const ex& argument : arguments)
      if (depends(argument))
        fail("has no derivative by '" + name_.get_name() + "', an unknown: '" + function +
             "' of it is not smooth; use smooth functions of it");
  }
  [[noreturn]] void fail(const std::string& why) const { throw DeckError(pointer_, "the expression \"" + text_ + "\" " + why); }

  GiNaC::symbol symbol(const std::string& name) { return symbols_.emplace(name, GiNaC::symbol(name)).first->second; }
  /// A symbol that stands for a text. Its name cannot be one of the deck's.
  GiNaC::symbol piece(const std::string& text) {
    const std::string name = "#" + std::to_string(pieces_.size()) + "#";
    pieces_.push_back(text);
    return symbol(name);
  }
  /// Text of a tree, with the pieces put in: later ones hold earlier ones.
  std::string written(const ex& e) const {
    std::string text = text_of(e);
    for (std::size_t begin = text.find('#'); begin != std::string::npos; begin = text.find('#', begin)) {
      const std::size_t end = text.find('#', begin + 1);
      text.replace(begin, end + 1 - begin, pieces_[std::stoul(text.substr(begin + 1, end - begin - 1))]);
    }
    return text;
  }

  /// The token that comes next, empty at the end.
  std::string next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (at_ == text_.size()) return {};
    const std::string rest = text_.substr(at_);
    for (const char* two : {"<=", ">=", "==", "!=", "&&", "||"})
      if (rest.compare(0, 2, two) == 0) return two;
    const auto in_word = [&](std::size_t i) {
      const auto c = static_cast<unsigned char>(rest[i]);
      const bool exponent_sign = (c == '+' || c == '-') && i > 0 && std::tolower(rest[i - 1]) == 'e' &&
                                 std::isalpha(static_cast<unsigned char>(rest[0])) == 0 && rest[0] != '_';
      return std::isalnum(c) || c == '_' || c == '.' || exponent_sign;
    };
    std::size_t length = 0;
    while (length < rest.size() && in_word(length)) ++length;
    return rest.substr(0, std::max<std::size_t>(length, 1));
  }
  void take(const std::string& token) {
    if (next() != token) fail("is not understood at '" + text_.substr(at_) + "': expected '" + token + "'");
    at_ += token.size();
  }

  std::string text_, pointer_;
  std::size_t at_ = 0;
  std::map<std::string, GiNaC::symbol> symbols_;
  GiNaC::symbol name_;
  std::vector<std::string> pieces_;
  std::vector<std::pair<GiNaC::symbol, ex>> slopes_;  // of conditions that depend on the name: their derivative
};

}  // namespace

std::string derivative_text(const std::string& text, const std::string& name, const std::string& pointer) {
  try {
    return Differentiator(text, name, pointer).derivative();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // GiNaC's own, such as a division by zero among the numbers
    throw DeckError(pointer, "the expression \"" + text + "\" cannot be differentiated by '" + name + "': " + error.what());
  }
}

}  // namespace jaxmpm
