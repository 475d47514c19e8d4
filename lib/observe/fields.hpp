#pragma once
// The one table of what can be observed of a particle: names, units and shapes feed HDF5, VTK, gauges and the choice of what a snapshot has
// to hold.
#include <string>
#include <vector>

#include "solvers/model_gradient.hpp"

namespace jaxmpm {

enum class Rank { scalar, vector, symmetric, gradient };  ///< symmetric tensors have six components (xx yy zz xy yz xz), also in 2D

struct OutputField {
  std::string name, symbol, unit;
  Rank rank;
  bool FieldSelection::*selected;             ///< what to ask the solver for; null where every snapshot has it
  std::vector<double> BodySnapshot::*values;  ///< null for the integers `id` and `body`
};

/// All fields, in the order in which they are written.
const std::vector<OutputField>& output_fields();
/// Throws Error (exit 2) naming the valid choices when there is no such field.
const OutputField& output_field(const std::string& name);

/// Shape of one particle's value (empty for a scalar), number of its components, and their names.
std::vector<std::size_t> value_shape(Rank rank, int dim);
std::size_t component_count(Rank rank, int dim);
std::vector<std::string> component_names(Rank rank, int dim);

/// Component k of a field at particle p of a body.
double field_value(const OutputField& field, const BodySnapshot& snapshot, std::size_t body, std::size_t p, std::size_t k,
                   std::size_t components);

/// Whether readings of a field can be differentiated by the particles of a snapshot: not the velocity gradient, which is the grid's.
bool has_derivative(const OutputField& field);
/// A field of a body's gradient for adding to, of `size` numbers; zeros where it was empty.
double* gradient_of(std::vector<double> BodySnapshot::*field, BodySnapshot& gradient, std::size_t size);
/// Adds `value`, ∂L/∂(component k of a field at particle p of `particles`), to a body's gradient: pressure is −tr σ/3, body and id are
/// constant. The field must have a derivative.
void add_field_gradient(const OutputField& field, double value, std::size_t p, std::size_t k, std::size_t components, std::size_t particles,
                        BodySnapshot& gradient);

FieldSelection selection(const std::vector<std::string>& fields);
FieldSelection operator|(const FieldSelection& a, const FieldSelection& b);

}  // namespace jaxmpm
