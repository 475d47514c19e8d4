#include "solvers/particle_gradient.hpp"

#include "materials/constants.hpp"

namespace jaxmpm {

template <class T, int Dim>
Particles<T, Dim> zero_bars(const Particles<T, Dim>& particles) {
  const std::size_t n = particles.count();
  const auto zeros = [n](std::size_t arrays) { return std::vector<Array<T>>(arrays, Array<T>(n, T(0))); };
  Particles<T, Dim> bar;
  bar.position.assign(Dim, Array<double>(n, 0.0)), bar.velocity = zeros(Dim), bar.affine = zeros(particles.affine.size());
  bar.history = zeros(particles.history.size()), bar.dilation = zeros(particles.dilation.size());
  bar.mass.assign(n, T(0)), bar.compression.assign(n, T(0));
  return bar;
}

template <class T, int Dim>
BodyGradient body_gradient(const Body& body, const MaterialAdjoint<T, Dim>& material, const Particles<T, Dim>& first,
                           const Particles<T, Dim>& bar, MaterialReport constants) {
  const std::size_t n = first.count();
  BodyGradient by;
  std::vector<double> by_compression(n), by_stress(6 * n);
  material.start(first, bar, by_compression.data(), by_stress.data(), constants);
  by.material = by_material_numbers(body.material, constants.constants.data());
  by.initial.velocity.resize(n), by.initial.mass.resize(n), by.initial.compression.resize(n), by.initial.stress.resize(n);
  const std::uint32_t first_id = first.first_id();
  for (std::size_t a = 0; a < n; ++a) {
    const std::size_t i = first.id[a] - first_id;
    for (std::size_t d = 0; d < Dim; ++d) by.initial.velocity[i][d] = double(bar.velocity[d][a]);
    by.initial.mass[i] = double(bar.mass[a]);
    by.initial.compression[i] = by_compression[a];
    for (std::size_t k = 0; k < 6; ++k) by.initial.stress[i][k] = by_stress[6 * a + k];
  }
  return by;
}

std::array<std::vector<double>, 6> by_face(const Model& model, const double* segments) {
  std::array<std::vector<double>, 6> faces;
  for (std::size_t f = 0; f < std::size_t(2 * model.dim); ++f) {
    const std::size_t count = model.faces[f].coefficient.size();
    faces[f].assign(segments, segments + count);
    segments += count;
  }
  return faces;
}

template Particles<float, 2> zero_bars(const Particles<float, 2>&);
template BodyGradient body_gradient(const Body&, const MaterialAdjoint<float, 2>&, const Particles<float, 2>&, const Particles<float, 2>&,
                                    MaterialReport);
template Particles<float, 3> zero_bars(const Particles<float, 3>&);
template BodyGradient body_gradient(const Body&, const MaterialAdjoint<float, 3>&, const Particles<float, 3>&, const Particles<float, 3>&,
                                    MaterialReport);
template Particles<double, 2> zero_bars(const Particles<double, 2>&);
template BodyGradient body_gradient(const Body&, const MaterialAdjoint<double, 2>&, const Particles<double, 2>&,
                                    const Particles<double, 2>&, MaterialReport);
template Particles<double, 3> zero_bars(const Particles<double, 3>&);
template BodyGradient body_gradient(const Body&, const MaterialAdjoint<double, 3>&, const Particles<double, 3>&,
                                    const Particles<double, 3>&, MaterialReport);

}  // namespace jaxmpm
