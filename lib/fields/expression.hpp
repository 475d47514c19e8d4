#pragma once
// A formula of x, y, z, where asked for of the time t, and of the deck's parameters, evaluated by muparser.
#include <memory>
#include <vector>

#include "fields/field.hpp"

namespace jaxmpm {

/// Not to be evaluated by two threads at once: muparser keeps the place in variables of its own.
class Expression : public Field {
 public:
  enum class Of { space, space_and_time };
  Expression(const std::string& text, int dim, const std::map<std::string, double>& parameters, const std::string& pointer,
             Of of = Of::space);
  ~Expression() override;
  double value(const std::array<double, 3>& place) const override;
  /// Value at a place (m) and a time (s).
  double value(const std::array<double, 3>& place, double time) const;

  /// As the deck gives it: the source of its derivatives.
  const std::string& text() const { return text_; }
  /// Names of the deck's parameters that it depends on.
  const std::vector<std::string>& parameters() const { return used_; }

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::string text_, pointer_;
  std::vector<std::string> used_;
};

}  // namespace jaxmpm
