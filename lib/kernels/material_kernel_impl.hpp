#pragma once
// A law (lib/materials) on batches of particles.
#include "kernels/batch.hpp"
#include "kernels/material_kernel.hpp"
#include "materials/registry.hpp"

namespace jaxmpm {

template <class T, int Dim, template <class> class Law>
class LawKernel final : public MaterialKernel<T, Dim> {
  static constexpr int W = batch<T>, history = Law<T>::template history_size<Dim>(), strain = Law<T>::template plastic_strain_index<Dim>();
  static constexpr int slots = history > 0 ? history : 1;  // arrays of size zero are no C++
  static_assert(history <= ParticleView<T, Dim>::most_history, "most_history has to grow with this law");
  using P = Pack<T, W>;
  Law<T> law_;
  Law<double> exact_;  // set-up and output

  static void read_history(const ParticleView<T, Dim>& p, std::size_t s, int count, P* h) {
    for (int k = 0; k < history; ++k) h[k] = load(p.history[std::size_t(k)].data() + s, count);
  }
  static P volume(const ParticleView<T, Dim>& p, std::size_t s, int count, P e, T density) {
    return load(p.mass.data() + s, count) / (P(density) * (P(T(1)) + e));
  }

 public:
  LawKernel(const Law<T>& law, const Law<double>& exact) : law_(law), exact_(exact) {}

  T reference_density() const override { return law_.density; }
  double diffusivity() const override { return double(law_.diffusivity()); }
  int history_size() const override { return history; }
  int plastic_strain_index() const override { return strain; }

  void stress(const ParticleView<T, Dim>& p, std::size_t s, int count, T sigma[][W]) const override {
    P h[slots];
    read_history(p, s, count, h);
    const auto value = law_.template stress<P, Dim>(load(p.compression.data() + s, count), h);
    for (int k = 0; k < value.size; ++k) value[k].store(sigma[k]);
  }

  void update(ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][W], const T speed[W], T dt, bool account,
              TileReport& report) const override {
    P h[slots];
    read_history(p, s, count, h);
    P e = load(p.compression.data() + s, count);
    Matrix<P, Dim> increment;
    for (int k = 0; k < Dim * Dim; ++k) increment.a[k] = P::load(H[k]);
    const P lost = law_.template update<P, Dim>(increment, P(dt), e, h);
    store(p.compression.data() + s, e, count);
    for (int k = 0; k < history; ++k) store(p.history[std::size_t(k)].data() + s, h[k], count);
    const P fastest = law_.template wave_speed<P, Dim>(e, h) + P::load(speed);
    // Comparisons that a NaN fails: nothing but finite values passes.
    if (any(!((e > P(T(-1))) & (e < P(T(1e6))) & (fastest < P(T(1e18)))))) report.sound = false;
    report.fastest = std::max(report.fastest, double(largest(fastest)));
    if (!account) return;
    (strain >= 0 ? report.plastic : report.viscous) += sum_of(lost * volume(p, s, count, e, law_.density), count);
  }

  void start(const double stress[6], double compression, double* h) const override {
    Symmetric<double, Dim> sigma;
    for (int k = 0; k < sigma.size; ++k) sigma[k] = stress[k];
    exact_.template start<double, Dim>(sigma, compression, h);
  }
  void stress(double compression, const double* h, double out[6]) const override {
    const auto sigma = exact_.template stress<double, Dim>(compression, h);
    for (int k = 0; k < 6; ++k) out[k] = k < sigma.size ? sigma[k] : 0.0;
  }
  double energy(double compression, const double* h) const override { return exact_.template energy<double, Dim>(compression, h); }
  double wave_speed(double compression, const double* h) const override { return exact_.template wave_speed<double, Dim>(compression, h); }
};

namespace material_detail {
/// The kernel of a law whose parameters are doubles: the same law again in the step's precision.
template <class T, int Dim, template <class> class Law>
std::unique_ptr<MaterialKernel<T, Dim>> make(const Law<double>& exact, const deck::Material& material) {
  std::unique_ptr<MaterialKernel<T, Dim>> kernel;
  with_law<T>(material, [&](const auto& law) {
    if constexpr (std::is_same_v<std::decay_t<decltype(law)>, Law<T>>) kernel = std::make_unique<LawKernel<T, Dim, Law>>(law, exact);
  });
  return kernel;
}
}  // namespace material_detail

template <class T, int Dim>
std::unique_ptr<MaterialKernel<T, Dim>> make_material_kernel(const deck::Material& material) {
  std::unique_ptr<MaterialKernel<T, Dim>> kernel;
  with_law<double>(material, [&](const auto& exact) { kernel = material_detail::make<T, Dim>(exact, material); });
  return kernel;
}

}  // namespace jaxmpm
