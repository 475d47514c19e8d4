#pragma once
// A solver simple enough to know every answer: particles that fly under gravity, x += Δt v after v += Δt g. Its stable step shrinks as they
// get faster.
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.hpp"
#include "solvers/solver.hpp"

namespace jaxmpm::testing {

/// A 2D model of one body "stone" with its particles on a diagonal.
inline Model ballistic_model(std::size_t count = 5) {
  Model model;
  model.dim = 2;
  model.cells = {10, 10, 1};
  model.cell_size = 0.1;
  model.gravity = {0, -10, 0};
  model.time.end = 1;
  Body body;
  body.name = "stone";
  body.material = deck::Newtonian{1000, 10, 0, std::nullopt};
  for (std::size_t p = 0; p < count; ++p) {
    body.initial.id.push_back(static_cast<std::uint32_t>(p));
    body.initial.position.push_back({double(p), double(p), 0});
    body.initial.velocity.push_back({1.0 + double(p), 0, 0});
    body.initial.mass.push_back(1.0);
    body.initial.compression.push_back(0.0);
  }
  model.bodies.push_back(body);
  return model;
}

class Ballistic : public Solver {
 public:
  explicit Ballistic(const Model& model) : h_(model.cell_size), gravity_(model.gravity) {
    for (std::size_t p = 0; p < model.bodies[0].initial.id.size(); ++p)
      for (int a = 0; a < 2; ++a) {
        x_.push_back(model.bodies[0].initial.position[p][a] * h_);
        v_.push_back(model.bodies[0].initial.velocity[p][a]);
      }
  }
  double stable_step() const override {
    double fastest = 0;
    for (const double v : v_) fastest = std::max(fastest, std::abs(v));
    return 0.02 / (1 + fastest);
  }
  void step(double dt) override {
    ++steps;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      v_[i] += dt * gravity_[i % 2];
      x_[i] += dt * v_[i];
    }
    time_ += dt;
    if (time_ > fails_at) {
      x_[0] = std::numeric_limits<double>::quiet_NaN();
      throw NumericsError("particle 0 is lost");
    }
  }
  std::uint64_t particle_count() const override { return x_.size() / 2; }
  std::vector<BodySnapshot> snapshot_within(const std::vector<Region>&, const FieldSelection& fields) const override {
    return snapshot(fields, false);
  }
  void take_snapshot(const FieldSelection&, bool, std::vector<BodySnapshot>& bodies) const override {
    BodySnapshot s;
    const std::size_t n = particle_count();
    for (std::size_t p = 0; p < n; ++p) s.id.push_back(static_cast<std::uint32_t>(p));
    s.position = x_;
    s.velocity = v_;
    s.mass.assign(n, 1.0);
    s.density.assign(n, 1000.0);
    s.pressure.assign(n, 5.0);
    s.stress.assign(6 * n, -5.0);
    s.velocity_gradient.assign(4 * n, 0.0);
    s.plastic_strain.assign(n, 0.0);
    s.strain_energy.assign(n, 0.0);
    bodies = {s};
  }
  void record_forces(bool) override {}
  ContactForces forces() const override { return {}; }
  Dissipation dissipation() const override { return {}; }
  std::vector<RawArray> save() const override { return {pack("x", x_), pack("a/v", v_), pack("time", {time_})}; }
  void restore(const std::vector<RawArray>& arrays) override {
    for (const RawArray& array : arrays) {
      std::vector<double> values(array.bytes.size() / sizeof(double));
      std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
      if (array.name == "x") x_ = values;
      if (array.name == "a/v") v_ = values;
      if (array.name == "time") time_ = values[0];
    }
  }
  double bytes_per_particle() const override { return 32; }
  PhaseSeconds phase_seconds() const override { return {}; }
  std::size_t active_blocks() const override { return 1; }
  std::uint64_t sorts() const override { return 0; }

  double fails_at = std::numeric_limits<double>::infinity();
  int steps = 0;

 private:
  static RawArray pack(const std::string& name, const std::vector<double>& values) {
    RawArray array{name, "f8", {values.size()}, std::vector<unsigned char>(values.size() * sizeof(double))};
    std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
    return array;
  }
  double h_, time_ = 0;
  Point gravity_;
  std::vector<double> x_, v_;
};

}  // namespace jaxmpm::testing
