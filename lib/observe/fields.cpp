#include "observe/fields.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace jaxmpm {

const std::vector<OutputField>& output_fields() {
  using S = FieldSelection;
  using B = BodySnapshot;
  static const std::vector<OutputField> table{
      {"id", "", "1", Rank::scalar, nullptr, nullptr},
      {"body", "", "1", Rank::scalar, nullptr, nullptr},
      {"position", "x", "m", Rank::vector, nullptr, &B::position},
      {"velocity", "v", "m/s", Rank::vector, &S::velocity, &B::velocity},
      {"density", "ρ", "kg/m³", Rank::scalar, &S::density, &B::density},
      {"pressure", "p", "Pa", Rank::scalar, &S::pressure, &B::pressure},
      {"stress", "σ", "Pa", Rank::symmetric, &S::stress, &B::stress},
      {"velocity_gradient", "∇v", "1/s", Rank::gradient, &S::velocity_gradient, &B::velocity_gradient},
      {"plastic_strain", "ε_p", "1", Rank::scalar, &S::plastic_strain, &B::plastic_strain},
  };
  return table;
}

const OutputField& output_field(const std::string& name) {
  std::string choices;
  for (const OutputField& field : output_fields()) {
    if (field.name == name) return field;
    choices += (choices.empty() ? "" : ", ") + field.name;
  }
  throw Error(ExitCode::deck, "there is no field '" + name + "'; choose from " + choices + ".");
}

std::vector<std::size_t> value_shape(Rank rank, int dim) {
  const auto d = static_cast<std::size_t>(dim);
  switch (rank) {
    case Rank::vector:
      return {d};
    case Rank::symmetric:
      return {6};
    case Rank::gradient:
      return {d, d};
    default:
      return {};
  }
}

std::size_t component_count(Rank rank, int dim) {
  std::size_t count = 1;
  for (const std::size_t extent : value_shape(rank, dim)) count *= extent;
  return count;
}

std::vector<std::string> component_names(Rank rank, int dim) {
  static const std::vector<std::string> axes{"x", "y", "z"};
  if (rank == Rank::scalar) return {};
  if (rank == Rank::vector) return {axes.begin(), axes.begin() + dim};
  if (rank == Rank::symmetric) return {"xx", "yy", "zz", "xy", "yz", "xz"};
  std::vector<std::string> names;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) names.push_back(axes[i] + axes[j]);
  return names;
}

double field_value(const OutputField& field, const BodySnapshot& snapshot, std::size_t body, std::size_t p, std::size_t k,
                   std::size_t components) {
  if (field.values) return (snapshot.*field.values)[p * components + k];
  return field.name == "id" ? static_cast<double>(snapshot.id[p]) : static_cast<double>(body);
}

bool has_derivative(const OutputField& field) { return field.name != "velocity_gradient"; }

double* gradient_of(std::vector<double> BodySnapshot::*field, BodySnapshot& gradient, std::size_t size) {
  std::vector<double>& values = gradient.*field;
  if (values.empty()) values.assign(size, 0.0);
  return values.data();
}

void add_field_gradient(const OutputField& field, double value, std::size_t p, std::size_t k, std::size_t components, std::size_t particles,
                        BodySnapshot& gradient) {
  if (!field.values) return;
  if (field.values != &BodySnapshot::pressure) {
    gradient_of(field.values, gradient, particles * components)[p * components + k] += value;
    return;
  }
  double* stress = gradient_of(&BodySnapshot::stress, gradient, 6 * particles);
  for (std::size_t a = 0; a < 3; ++a) stress[6 * p + a] -= value / 3;
}

FieldSelection selection(const std::vector<std::string>& fields) {
  FieldSelection chosen;
  for (const std::string& name : fields)
    if (const OutputField& field = output_field(name); field.selected) chosen.*field.selected = true;
  return chosen;
}

FieldSelection operator|(const FieldSelection& a, const FieldSelection& b) {
  return {a.velocity || b.velocity,
          a.density || b.density,
          a.pressure || b.pressure,
          a.stress || b.stress,
          a.velocity_gradient || b.velocity_gradient,
          a.plastic_strain || b.plastic_strain,
          a.energy || b.energy};
}

}  // namespace jaxmpm
