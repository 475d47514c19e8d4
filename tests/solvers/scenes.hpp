#pragma once
// Small scenes with everything in them, built by hand, for tests of the stepper.
#include <cmath>
#include <random>

#include "fields/body_force.hpp"
#include "scene/model.hpp"

namespace jaxmpm {

inline deck::Newtonian water(double viscosity = 0) {
  deck::Newtonian m;
  m.density = 1000, m.sound_speed = 20, m.viscosity = viscosity, m.tension_limit = 0;
  return m;
}
inline deck::DruckerPrager sand() {
  deck::DruckerPrager m;
  m.density = 2000, m.friction_angle = 30, m.bulk_modulus = 4e5, m.poisson_ratio = 0.3, m.dilation_angle = 5;
  return m;
}

inline deck::LinearElastic elastic() {
  deck::LinearElastic m;
  m.density = 1500, m.youngs_modulus = 1e5, m.poisson_ratio = 0.3;
  return m;
}
inline deck::NeoHookean rubber() {
  deck::NeoHookean m;
  m.density = 1100, m.youngs_modulus = 1e5, m.poisson_ratio = 0.4;
  return m;
}

/// A body of jittered particles, 2 per cell and axis, in the box of cells [lower, upper), with smooth random velocity, compression and (for
/// solids) stress.
inline Body jittered_body(const std::string& name, const deck::Material& material, int dim, const Point& lower, const Point& upper,
                          double cell_size, std::uint32_t first_id, double speed, double stress) {
  Body body{name, material, {}};
  std::mt19937_64 random(first_id + 7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const double density = std::visit([](const auto& m) { return m.density; }, material);
  for (double x = lower[0] + 0.25; x < upper[0]; x += 0.5)
    for (double y = lower[1] + 0.25; y < upper[1]; y += 0.5)
      for (double z = dim == 3 ? lower[2] + 0.25 : 0; z < (dim == 3 ? upper[2] : 0.1); z += 0.5) {
        Point X{x, y, z};
        for (int d = 0; d < dim; ++d) X[std::size_t(d)] += 0.22 * unit(random);
        Point v{};
        for (int d = 0; d < dim; ++d)
          v[std::size_t(d)] = speed * (std::sin(0.4 * X[0] + d) - 0.7 * std::cos(0.3 * X[1] - d) + 0.2 * unit(random));
        body.initial.id.push_back(first_id + std::uint32_t(body.initial.id.size()));
        body.initial.position.push_back(X), body.initial.velocity.push_back(v);
        body.initial.mass.push_back(density * std::pow(cell_size / 2, dim) * (1 + 0.2 * unit(random)));
        body.initial.compression.push_back(1e-3 * (1 + unit(random)));
        std::array<double, 6> sigma{};
        for (int k = 0; k < (dim == 2 ? 4 : 6); ++k) sigma[std::size_t(k)] = stress * ((k < 3 ? -2 : 0) + 0.5 * unit(random));
        body.initial.stress.push_back(sigma);
      }
  return body;
}

/// A half-space below a tilted plane through `through` (cells).
inline RigidObstacle tilted_ground(int dim, const Point& through, deck::ContactKind kind, double coefficient) {
  const Point n = dim == 2 ? Point{-0.6, 0.8, 0} : Point{-0.48, 0.36, 0.8};
  const auto distance = [=](const Point& x) {
    double s = 0;
    for (std::size_t d = 0; d < 3; ++d) s += n[d] * (x[d] - through[d]);
    return SignedDistance{s, n};
  };
  return {"ground", kind, coefficient, distance, [](const Point&, const Point&) { return true; }};
}

/// Two touching bodies in a corner of the domain, pressed against its faces, and a tilted obstacle.
inline Model busy_scene(int dim, const deck::Method& method, const deck::Material& first, const deck::Material& second,
                        deck::ContactKind kind) {
  Model model;
  model.dim = dim, model.method = method;
  model.cells = dim == 2 ? std::array<int, 3>{24, 19, 1} : std::array<int, 3>{13, 9, 10};
  model.cell_size = 0.02, model.domain_min = {3, -2, 1};
  model.gravity = dim == 2 ? Point{1.5, -9.5, 0} : Point{1.5, 0.5, -9.5};
  for (std::size_t f = 0; f < 6; ++f) {
    model.faces[f].kind = kind;
    if (kind != deck::ContactKind::friction) continue;
    model.faces[f].segment_axis = f < 2 ? 1 : 0;
    model.faces[f].coefficient = {0.6, 0.1, 0.3}, model.faces[f].to = {2.5, 5, double(model.cells[f < 2 ? 1 : 0])};
  }
  const double top = dim == 2 ? model.cells[1] : 5;
  model.bodies.push_back(jittered_body("one", first, dim, {0, 0, 0}, {7, top, 5}, model.cell_size, 0, 0.8, 500));
  model.bodies.push_back(
      jittered_body("two", second, dim, {7, 0, 0}, {dim == 2 ? 24. : 13., dim == 2 ? 6. : 9., 4}, model.cell_size, 100000, 0.8, 500));
  model.obstacles.push_back(tilted_ground(dim, dim == 2 ? Point{13, 3, 0} : Point{8, 4, 2},
                                          kind == deck::ContactKind::slip ? deck::ContactKind::friction : kind, 0.3));
  return model;
}

/// Material at a separate face that the first step would take through it: the face's own nodes see it leave, those within push it out.
inline Model creeping_scene(int dim, const deck::Method& method) {
  Model model = busy_scene(dim, method, water(1), sand(), deck::ContactKind::separate);
  model.gravity = {}, model.obstacles.clear();
  const auto up = std::size_t(dim - 1);
  for (Body& body : model.bodies)
    for (std::size_t a = 0; a < body.initial.id.size(); ++a) {
      double &X = body.initial.position[a][up], &v = body.initial.velocity[a][up];
      if (X < 0.5) X = 1e-5, v = 0.1, body.initial.mass[a] *= 0.2;
      else if (X < 1.5) X = 1.4, v = -1.5;
    }
  return model;
}

/// A scene with a body force over space and time, damping, and walls that move where they hold what touches them.
inline Model driven(Model model) {
  const std::vector<deck::Formula> force{"300*sin(50*x)*cos(700*t)", "A*y*x - 100*t", 5.0};
  model.body_force = std::make_shared<const BodyForce>(std::vector<deck::Formula>(force.begin(), force.begin() + model.dim), model.dim,
                                                       std::map<std::string, double>{{"A", 40}});
  model.method.damping = 200;
  for (std::size_t f = 0; f < 6; ++f)
    if (model.faces[f].kind == deck::ContactKind::no_slip || model.faces[f].kind == deck::ContactKind::friction)
      for (std::size_t c = 0; c < std::size_t(model.dim); ++c)
        if (c != f / 2) model.faces[f].velocity[c] = 0.3 + 0.1 * double(f) - 0.2 * double(c);
  return model;
}

/// The same without ends along x, in 3D along z too: one body around the faces, one on it.
inline Model periodic_scene(int dim, const deck::Method& method, const deck::Material& first, const deck::Material& second,
                            deck::ContactKind kind) {
  Model model = busy_scene(dim, method, first, second, kind);
  model.cells = dim == 2 ? std::array<int, 3>{16, 19, 1} : std::array<int, 3>{8, 9, 12};
  for (std::size_t f : {0, 1, 4, 5})
    if (f < 2 || dim == 3) model.faces[f] = {deck::ContactKind::periodic, {}, {}, 0, {}};
  const Point top{double(model.cells[0]), 4, double(model.cells[2])};
  model.bodies[0] = jittered_body("one", first, dim, {0, 0, 0}, top, model.cell_size, 0, 0.8, 500);
  model.bodies[1] = jittered_body("two", second, dim, {2, 4, 2}, {5, 6, 5}, model.cell_size, 100000, 0.8, 500);
  model.obstacles[0] = tilted_ground(dim, {6, 1, 2}, kind == deck::ContactKind::slip ? deck::ContactKind::friction : kind, 0.3);
  return driven(model);
}

}  // namespace jaxmpm
