#include "fields/mlp.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "fields/random.hpp"

namespace jaxmpm {
namespace {

std::size_t weight_count(const std::vector<int>& widths) {
  std::size_t count = 0;
  for (std::size_t l = 0; l + 1 < widths.size(); ++l) count += static_cast<std::size_t>(widths[l] + 1) * widths[l + 1];
  return count;
}

std::vector<double> initial_weights(const std::vector<int>& widths, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<double> weights;
  weights.reserve(weight_count(widths));
  for (std::size_t l = 0; l + 1 < widths.size(); ++l) {
    const double deviation = std::sqrt(2.0 / widths[l]);
    for (int i = 0; i < widths[l] * widths[l + 1]; ++i) weights.push_back(deviation * random.normal());
    const double width = l + 2 < widths.size() ? 1 / std::sqrt(widths[l]) : 0;
    for (int j = 0; j < widths[l + 1]; ++j) weights.push_back(width * (2 * random.uniform() - 1));
  }
  return weights;
}

}  // namespace

Mlp::Mlp(const deck::Mlp& description, int dim, const std::string& pointer)
    : center_(description.input_center),
      scale_(description.input_scale),
      tanh_(description.activation == "tanh"),
      output_scale_(description.output_scale) {
  if (!tanh_ && description.activation != "relu")
    throw DeckError(pointer + "/activation", "unknown activation '" + description.activation + "'; valid are relu, tanh");
  for (std::size_t i = 0; i < description.inputs.size(); ++i) {
    inputs_.push_back(coordinate_index(description.inputs[i], dim));
    if (inputs_.back() < 0)
      throw DeckError(pointer + "/inputs/" + std::to_string(i),
                      "'" + description.inputs[i] + "' is no coordinate; valid are " + (dim == 3 ? "x, y, z" : "x, y"));
  }
  if (inputs_.empty()) throw DeckError(pointer + "/inputs", "a network needs at least one input coordinate");
  if (center_.empty()) center_.assign(inputs_.size(), 0.0);
  if (scale_.empty()) scale_.assign(inputs_.size(), 1.0);
  for (const auto& [key, numbers] : {std::pair{"/input_center", &center_}, std::pair{"/input_scale", &scale_}})
    if (numbers->size() != inputs_.size())
      throw DeckError(pointer + key, "give one number for each input (" + std::to_string(inputs_.size()) + "), here are " +
                                         std::to_string(numbers->size()));
  widths_.push_back(static_cast<int>(inputs_.size()));
  for (std::size_t i = 0; i < description.hidden.size(); ++i) {
    if (description.hidden[i] < 1) throw DeckError(pointer + "/hidden/" + std::to_string(i), "a layer has at least one neuron");
    widths_.push_back(description.hidden[i]);
  }
  widths_.push_back(1);
  weights_ = description.weights.empty() ? initial_weights(widths_, description.seed) : description.weights;
  if (weights_.size() != weight_count(widths_))
    throw DeckError(pointer + "/weights",
                    "the network has " + std::to_string(weight_count(widths_)) + " weights, here are " + std::to_string(weights_.size()));
}

std::vector<std::vector<double>> Mlp::layers(const std::array<double, 3>& place) const {
  std::vector<std::vector<double>> values(widths_.size());
  for (std::size_t i = 0; i < inputs_.size(); ++i) values[0].push_back(scale_[i] * (place[inputs_[i]] - center_[i]));
  const double* w = weights_.data();
  for (std::size_t l = 0; l + 1 < widths_.size(); ++l) {
    const double* bias = w + static_cast<std::size_t>(widths_[l]) * widths_[l + 1];
    values[l + 1].assign(bias, bias + widths_[l + 1]);
    for (double& neuron : values[l + 1])
      for (const double a : values[l]) neuron += *w++ * a;
    w += widths_[l + 1];
    if (l + 2 < widths_.size())
      for (double& neuron : values[l + 1]) neuron = tanh_ ? std::tanh(neuron) : std::max(0.0, neuron);
  }
  return values;
}

double Mlp::value(const std::array<double, 3>& place) const { return output_scale_ * layers(place).back()[0]; }

void Mlp::add_gradient(const std::array<double, 3>& place, double by_value, double* by_weights) const {
  const std::vector<std::vector<double>> values = layers(place);
  std::vector<double> by_layer{output_scale_ * by_value};  // by the neurons of layer l + 1, before activation
  std::size_t end = weights_.size();
  for (std::size_t l = widths_.size() - 1; l-- > 0;) {
    const auto in = static_cast<std::size_t>(widths_[l]), out = static_cast<std::size_t>(widths_[l + 1]), begin = end - (in + 1) * out;
    std::vector<double> below(in, 0.0);
    for (std::size_t j = 0; j < out; ++j) {
      for (std::size_t i = 0; i < in; ++i) {
        by_weights[begin + j * in + i] += by_layer[j] * values[l][i];
        below[i] += by_layer[j] * weights_[begin + j * in + i];
      }
      by_weights[begin + in * out + j] += by_layer[j];
    }
    for (std::size_t i = 0; i < in; ++i) below[i] *= tanh_ ? 1 - values[l][i] * values[l][i] : (values[l][i] > 0 ? 1 : 0);
    by_layer = std::move(below);
    end = begin;
  }
}

}  // namespace jaxmpm
