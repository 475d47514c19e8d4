#pragma once
// Small models for the tests of the reference step.
#include <cmath>
#include <random>
#include <string>

#include "reference/step.hpp"

namespace jaxmpm::test {

struct Scheme {
  deck::Transfer transfer;
  deck::Basis basis;
  deck::GradientForm gradient;
};

inline std::string name_of(const Scheme& s) {
  const char* transfer[] = {"pic", "flip", "apic", "tpic"};
  const char* basis[] = {"linear", "quadratic", "cubic"};
  return std::string(transfer[int(s.transfer)]) + " " + basis[int(s.basis)] + (s.gradient == deck::GradientForm::mls ? " mls" : " spline");
}

inline std::vector<Scheme> every_scheme() {
  using namespace deck;
  std::vector<Scheme> all;
  for (const Transfer t : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::tpic})
    for (const Basis b : {Basis::linear, Basis::quadratic, Basis::cubic})
      for (const GradientForm g : {GradientForm::spline, GradientForm::mls})
        if (b != Basis::linear || g == GradientForm::spline) all.push_back({t, b, g});
  return all;
}

inline Model empty_model(int dim, std::array<int, 3> cells, double cell_size = 0.1) {
  Model model;
  model.dim = dim;
  model.cells = cells;
  if (dim == 2) model.cells[2] = 1;
  model.cell_size = cell_size;
  return model;
}

inline void use(Model& model, const Scheme& scheme) {
  model.method.transfer = scheme.transfer;
  model.method.basis = scheme.basis;
  model.method.gradient = scheme.gradient;
}

inline deck::Newtonian fluid(double sound_speed = 20, double viscosity = 0) {
  deck::Newtonian m;
  m.density = 1000;
  m.sound_speed = sound_speed;
  m.viscosity = viscosity;
  return m;
}

inline deck::NeoHookean jelly() {
  deck::NeoHookean m;
  m.density = 1100;
  m.youngs_modulus = 1e5;
  m.poisson_ratio = 0.3;
  return m;
}

/// A box of particles on the grid's lattice, k per cell and axis, at rest and without stress; corners in cells.
inline Body block(const Model& model, const std::string& name, const deck::Material& material, const Point& lower, const Point& upper,
                  int k) {
  Body body;
  body.name = name;
  body.material = material;
  const double volume = std::pow(model.cell_size / k, model.dim);
  const int layers = model.dim == 3 ? int(std::lround((upper[2] - lower[2]) * k)) : 1;
  for (int c = 0; c < layers; ++c)
    for (int b = 0; b < std::lround((upper[1] - lower[1]) * k); ++b)
      for (int a = 0; a < std::lround((upper[0] - lower[0]) * k); ++a) {
        body.initial.id.push_back(std::uint32_t(body.initial.id.size()));
        body.initial.position.push_back(
            {lower[0] + (a + 0.5) / k, lower[1] + (b + 0.5) / k, model.dim == 3 ? lower[2] + (c + 0.5) / k : 0});
        body.initial.velocity.push_back({0, 0, 0});
        body.initial.mass.push_back(deck::reference_density(material) * volume);
        body.initial.compression.push_back(0);
      }
  return body;
}

/// Moves particles off the lattice and gives them velocities and masses of their own; seeded.
inline void disturb(const Model& model, Body& body, double speed, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::size_t p = 0; p < body.initial.mass.size(); ++p) {
    for (int a = 0; a < model.dim; ++a) {
      body.initial.position[p][a] += 0.2 * uniform(random);
      body.initial.velocity[p][a] = speed * uniform(random);
    }
    body.initial.mass[p] *= 1 + 0.3 * uniform(random);
    body.initial.compression[p] = 1e-3 * uniform(random);
  }
}

/// Gives every particle an affine matrix with random entries, as a run would have left it.
inline void disturb_affine(const Model& model, ReferenceState<double>& state, double rate, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-rate, rate);
  for (ReferenceBody<double>& body : state.bodies)
    for (auto& C : body.affine)
      for (int i = 0; i < model.dim; ++i)
        for (int j = 0; j < model.dim; ++j) C[i][j] = uniform(random);
}

inline double total_mass(const ReferenceState<double>& state) {
  double sum = 0;
  for (const auto& body : state.bodies)
    for (const double m : body.mass) sum += m;
  return sum;
}

inline Triple<double> total_momentum(const ReferenceState<double>& state) {
  Triple<double> sum{};
  for (const auto& body : state.bodies)
    for (std::size_t p = 0; p < body.mass.size(); ++p)
      for (int c = 0; c < 3; ++c) sum[c] += body.mass[p] * body.velocity[p][c];
  return sum;
}

}  // namespace jaxmpm::test
