#include "fields/field.hpp"

#include "fields/expression.hpp"
#include "fields/mlp.hpp"

namespace jaxmpm {
namespace {

class Constant : public Field {
 public:
  explicit Constant(double value) : value_(value) {}
  double value(const std::array<double, 3>&) const override { return value_; }

 private:
  double value_;
};

struct MakeField {
  int dim;
  const std::map<std::string, double>& parameters;
  const std::string& pointer;
  std::unique_ptr<Field> operator()(double number) const { return std::make_unique<Constant>(number); }
  std::unique_ptr<Field> operator()(const std::string& text) const { return std::make_unique<Expression>(text, dim, parameters, pointer); }
  std::unique_ptr<Field> operator()(const deck::Mlp& mlp) const { return std::make_unique<Mlp>(mlp, dim, pointer + "/mlp"); }
};

}  // namespace

std::unique_ptr<Field> make_field(const deck::Component& component, int dim, const std::map<std::string, double>& parameters,
                                  const std::string& pointer) {
  return std::visit(MakeField{dim, parameters, pointer}, component);
}

int coordinate_index(const std::string& name, int dim) {
  const std::string names = dim == 3 ? "xyz" : "xy";
  const std::size_t index = name.size() == 1 ? names.find(name) : std::string::npos;
  return index == std::string::npos ? -1 : static_cast<int>(index);
}

}  // namespace jaxmpm
