#pragma once
// Analytic clouds of particles for gauges.
#include <algorithm>
#include <cmath>

#include "observe/gauges.hpp"

namespace jaxmpm::testing {

/// A 2D or 3D model of cell size `h` with gravity along the last axis and one body "sand".
inline Model empty_model(int dim, std::array<int, 3> cells, double h) {
  Model model;
  model.dim = dim;
  model.cells = cells;
  model.cell_size = h;
  model.gravity[dim - 1] = -10;
  model.bodies.resize(1);
  model.bodies[0].name = "sand";
  return model;
}

/// Particles on a lattice of `per_axis` in each cell, wherever inside(x) holds; density 1000, all fields present.
template <class Inside>
BodySnapshot fill(const Model& model, int per_axis, const Inside& inside) {
  BodySnapshot s;
  const double spacing = model.cell_size / per_axis, volume = std::pow(spacing, model.dim);
  const int nz = model.dim == 3 ? model.cells[2] * per_axis : 1;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < model.cells[1] * per_axis; ++j)
      for (int i = 0; i < model.cells[0] * per_axis; ++i) {
        const Point x{model.domain_min[0] + (i + 0.5) * spacing, model.domain_min[1] + (j + 0.5) * spacing,
                      model.domain_min[2] + (k + 0.5) * spacing};
        if (!inside(x)) continue;
        s.id.push_back(static_cast<std::uint32_t>(s.id.size()));
        for (int a = 0; a < model.dim; ++a) {
          s.position.push_back(x[a]);
          s.velocity.push_back(a + 1.0);
        }
        s.mass.push_back(1000 * volume);
        s.density.push_back(1000);
        s.pressure.push_back(3 * x[0] + 2 * x[1]);
        s.strain_energy.push_back(0.5 * volume);
      }
  s.stress.assign(6 * s.id.size(), -1);
  s.plastic_strain.assign(s.id.size(), 0.25);
  return s;
}

inline Sample read(const Gauge& gauge, const std::vector<BodySnapshot>& bodies, const Dissipation& lost = {},
                   const std::vector<double>* first = nullptr) {
  static const ContactForces none;
  return gauge.measure({{1, 0.1, 0.1, 0}, bodies, none, lost}, first);
}

}  // namespace jaxmpm::testing
