#include "fields/body_force.hpp"

#include "fields/expression.hpp"

namespace jaxmpm {

/// The components for one thread: null where the component is the number.
struct ForceExpressions {
  std::array<double, 3> number{};
  std::array<std::unique_ptr<Expression>, 3> expression;
};

BodyForce::BodyForce(const std::vector<deck::Formula>& components, int dim, const std::map<std::string, double>& parameters)
    : components_(components), dim_(dim), parameters_(parameters) {
  idle_.push_back(parsed());
}

BodyForce::~BodyForce() = default;

std::unique_ptr<ForceExpressions> BodyForce::parsed() const {
  auto made = std::make_unique<ForceExpressions>();
  for (std::size_t d = 0; d < components_.size(); ++d) {
    if (const auto* text = std::get_if<std::string>(&components_[d]))
      made->expression[d] =
          std::make_unique<Expression>(*text, dim_, parameters_, "/body_force/" + std::to_string(d), Expression::Of::space_and_time);
    else made->number[d] = std::get<double>(components_[d]);
  }
  return made;
}

std::vector<std::string> BodyForce::parameters() const {
  std::vector<std::string> names;
  for (const std::unique_ptr<Expression>& one : parsed()->expression)
    if (one) names.insert(names.end(), one->parameters().begin(), one->parameters().end());
  return names;
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

}  // namespace jaxmpm
