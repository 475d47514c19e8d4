#pragma once
// A small fully connected network (multi-layer perceptron) of coordinates, as Du & He 2025 (section 5.2) use it for an unknown initial
// velocity.
#include "fields/field.hpp"

namespace jaxmpm {

/// value = output_scale · (W_L a_L + b_L), a_{l+1} = activation(W_l a_l + b_l), a_0 = (inputs − input_center) (m) times input_scale, entry
/// by entry. Weights that the deck does not give start as normal deviates with variance 2/n (He et al. 2015, Eq 10), n the layer's number
/// of inputs; biases of hidden layers as uniform ones within ±1/√n, so that the kinks of the first layer lie apart, and the last as zero.
/// The draw depends on the seed alone (fields/random.hpp).
class Mlp : public Field {
 public:
  /// Throws DeckError for inputs that are no coordinate, an unknown activation, or an input_center (empty: zeros), input_scale (empty:
  /// ones) or weights of the wrong length.
  Mlp(const deck::Mlp& description, int dim, const std::string& pointer);
  double value(const std::array<double, 3>& place) const override;

  /// Adds by_value · ∂value/∂weights at a place (reverse mode) to `by_weights`, in the order of weights(). ReLU is differentiated as taken,
  /// with slope 0 at 0.
  void add_gradient(const std::array<double, 3>& place, double by_value, double* by_weights) const;

  /// All weights, layer by layer: the matrix row by row (one row for each output), then the biases.
  const std::vector<double>& weights() const { return weights_; }

 private:
  /// Values of each layer at a place: inputs, hidden layers after activation, the output before its scale.
  std::vector<std::vector<double>> layers(const std::array<double, 3>& place) const;

  std::vector<int> inputs_;             // coordinate index of each
  std::vector<double> center_, scale_;  // of each input
  std::vector<int> widths_;             // inputs, hidden…, 1
  bool tanh_;                           // else ReLU
  double output_scale_;
  std::vector<double> weights_;
};

}  // namespace jaxmpm
