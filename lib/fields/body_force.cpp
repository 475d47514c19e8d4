#include "fields/body_force.hpp"

#include <set>

#include "core/error.hpp"
#include "fields/expression.hpp"
#include "fields/expression_derivative.hpp"

namespace jaxmpm {

/// The components for one thread: null where the component is the number.
struct ForceExpressions {
  using Components = std::array<std::unique_ptr<Expression>, 3>;
  std::array<double, 3> number{};
  Components expression;
  std::vector<Components> slope;  // [parameter] when it has been asked for; null where it is zero or there is none
};

namespace {

std::string pointer_to(std::size_t component) { return "/body_force/" + std::to_string(component); }

}  // namespace

BodyForce::BodyForce(const std::vector<deck::Formula>& components, int dim, const std::map<std::string, double>& parameters)
    : components_(components), dim_(dim), parameters_(parameters) {
  idle_.push_back(parsed());
  std::set<std::string> names;
  for (const std::unique_ptr<Expression>& one : idle_.front()->expression)
    if (one) names.insert(one->parameters().begin(), one->parameters().end());
  names_.assign(names.begin(), names.end());
}

BodyForce::~BodyForce() = default;

std::unique_ptr<ForceExpressions> BodyForce::parsed() const {
  auto made = std::make_unique<ForceExpressions>();
  for (std::size_t d = 0; d < components_.size(); ++d) {
    if (const auto* text = std::get_if<std::string>(&components_[d]))
      made->expression[d] = std::make_unique<Expression>(*text, dim_, parameters_, pointer_to(d), Expression::Of::space_and_time);
    else made->number[d] = std::get<double>(components_[d]);
  }
  return made;
}

std::string BodyForce::slope_text(std::size_t component, const std::string& parameter) const {
  const auto* text = component < components_.size() ? std::get_if<std::string>(&components_[component]) : nullptr;
  return text ? derivative_text(*text, parameter, pointer_to(component)) : "0";
}

/// By one thread at a time, as GiNaC asks for.
void BodyForce::parse_slopes(ForceExpressions& expressions) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::string& name : names_) {
    ForceExpressions::Components& slope = expressions.slope.emplace_back();
    for (std::size_t d = 0; d < slope.size(); ++d) {
      try {
        const std::string text = slope_text(d, name);
        if (text != "0") slope[d] = std::make_unique<Expression>(text, dim_, parameters_, pointer_to(d), Expression::Of::space_and_time);
      } catch (const DeckError&) {
        // whoever asks for it hears of it from slope_text()
      }
    }
  }
}

BodyForce::Loan::Loan(const BodyForce& from) : from_(from) {
  {
    const std::lock_guard<std::mutex> lock(from.mutex_);
    if (!from.idle_.empty()) {
      expressions_ = std::move(from.idle_.back());
      from.idle_.pop_back();
    }
  }
  if (!expressions_) expressions_ = from.parsed();
}

BodyForce::Loan::~Loan() {
  const std::lock_guard<std::mutex> lock(from_.mutex_);
  from_.idle_.push_back(std::move(expressions_));
}

std::array<double, 3> BodyForce::Loan::at(const std::array<double, 3>& place, double time) const {
  std::array<double, 3> force = expressions_->number;
  for (std::size_t d = 0; d < 3; ++d)
    if (expressions_->expression[d]) force[d] = expressions_->expression[d]->value(place, time);
  return force;
}

void BodyForce::Loan::add_slopes(const std::array<double, 3>& place, double time, const std::array<double, 3>& by, double* sums) const {
  if (expressions_->slope.size() != from_.names_.size()) from_.parse_slopes(*expressions_);
  for (std::size_t d = 0; d < 3; ++d) {
    sums[d] += by[d];
    for (std::size_t k = 0; k < expressions_->slope.size(); ++k)
      if (expressions_->slope[k][d]) sums[3 + k] += by[d] * expressions_->slope[k][d]->value(place, time);
  }
}

}  // namespace jaxmpm
