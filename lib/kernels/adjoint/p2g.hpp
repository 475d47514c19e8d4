#pragma once
// Adjoint of the transfer from particles to grid: the reverse of a scatter is a gather, of the nodes' derivatives this time.
#include "kernels/adjoint/contract.hpp"
#include "kernels/adjoint/material_adjoint.hpp"
#include "kernels/g2p.hpp"

namespace jaxmpm {

/// Where the derivatives by what a particle gave are gathered: per plane the group with w, then Dim with d and Dim with g as far as it has
/// them; in 2D those by m and m θ by themselves.
template <class Sch>
struct GatheredBars {
  using Q = Coefficients<Sch>;
  static constexpr int Dim = Sch::Dim, V = Sch::V, W = batch<typename Sch::T>;
  static constexpr bool with_d = Sch::p2g_moments, with_g = Sch::p2g_slopes;
  static constexpr bool full(int plane) { return plane == (Sch::flip ? 1 : 0); }  // has more than the value
  static constexpr int groups(int plane) { return full(plane) ? 1 + Dim * (int(with_d) + int(with_g)) : 1; }
  static constexpr int first(int plane) { return plane == 0 ? 0 : groups(0); }
  static constexpr int force = first(Sch::flip ? 1 : 0) + 1 + (with_d && with_g ? Dim : 0);
  static constexpr int ends = Sch::planes == 1 ? groups(0) : groups(0) + groups(1);
  static constexpr int mass = Dim == 3 ? 0 : V * ends;
  static constexpr int theta = !Sch::dilation ? -1 : (Dim == 3 ? V * first(Sch::dilation_plane) + Sch::dilation_lane : V * ends + 1);
  static constexpr int size = Dim == 3 ? V * ends : V * ends + 1 + int(Sch::dilation), padded = round_up(size, W);
  static constexpr PlaneTerms in_plane(int plane) {
    const int value = first(plane), moments = value + 1, slopes = with_d ? moments + Dim : moments;
    return {value, full(plane) && with_d ? moments : -1, full(plane) && with_g ? slopes : -1};
  }
};

/// Adjoint of Coefficients: what the gathered derivatives by a particle's coefficients bring to its fields.
template <class Sch>
JAXMPM_INLINE void coefficients_adjoint(const ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                        const Coefficients<Sch>& of, const typename Coefficients<Sch>::Stress& sigma,
                                        const Pack<typename Sch::T, batch<typename Sch::T>>* gathered,
                                        const MaterialKernel<typename Sch::T, Sch::Dim>& material,
                                        const MaterialAdjoint<typename Sch::T, Sch::Dim>& material_adjoint,
                                        const StepConstants<typename Sch::T>& step, ParticleView<typename Sch::T, Sch::Dim>& bar,
                                        MaterialReport& report) {
  using T = typename Sch::T;
  using G = GatheredBars<Sch>;
  constexpr int W = batch<T>, Dim = Sch::Dim;
  using P = Pack<T, W>;
  const auto by_component = [&](int group, int c) { return gathered[G::V * group + Sch::vector_at + c]; };
  const auto add = [&](FieldView<T>& field, P value) { store(field.data() + s, load(field.data() + s, count) + value, count); };
  P by_mass = gathered[G::mass];
  for (int c = 0; c < Dim; ++c) {
    by_mass += by_component(0, c) * load(p.velocity[std::size_t(c)].data() + s, count);
    add(bar.velocity[std::size_t(c)], of.m * by_component(0, c));
  }
  if constexpr (Sch::dilation)
    if (!p.dilation.empty()) {
      by_mass += gathered[G::theta] * load(p.dilation[0].data() + s, count);
      add(bar.dilation[0], of.m * gathered[G::theta]);
    }
  if constexpr (Sch::affine) {
    constexpr int first_moment = 1;
    const P size(step.cell_size);
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        const P by = size * by_component(first_moment + k, c);
        by_mass += by * load(p.affine[std::size_t(c * Dim + k)].data() + s, count);
        add(bar.affine[std::size_t(c * Dim + k)], of.m * by);
      }
  }
  alignas(64) T by_sigma[Symmetric<T, Dim>::size][W];
  const P impulse = of.m * of.per_mass;
  P by_impulse(T(0)), by_stress[Symmetric<T, Dim>::size];
  for (P& b : by_stress) b = P(T(0));
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) {
      const int at = Symmetric<T, Dim>::index(c, k);
      by_impulse += by_component(G::force + k, c) * P::load(sigma[at]);
      by_stress[at] += impulse * by_component(G::force + k, c);
    }
  by_mass += by_impulse * of.per_mass;
  add(bar.mass, by_mass);
  const P by_volume = by_impulse * impulse;
  add(bar.compression, -by_volume * of.growth);
  report.constants[0] -= sum_of(by_volume, count) / double(material.reference_density());
  for (int k = 0; k < Symmetric<T, Dim>::size; ++k) by_stress[k].store(by_sigma[k]);
  material_adjoint.stress(p, s, count, by_sigma, bar, report);
}

/// Adjoint of p2g_tile, a batch after the other: adds to `bar` what the derivatives by the nodes' sums ({m̄, p̄}, and {–, impulse} of a second
/// plane) bring.
template <class Sch>
class P2gAdjoint {
  using T = typename Sch::T;
  using Q = Coefficients<Sch>;
  using G = GatheredBars<Sch>;
  using Contract = NodeContraction<Sch, true>;
  static constexpr int Dim = Sch::Dim, W = batch<T>;

 public:
  P2gAdjoint(const MaterialKernel<T, Dim>& material, const MaterialAdjoint<T, Dim>& material_adjoint, const StepConstants<T>& step,
             const Index<Dim>& origin, const Nodes<Sch, true>& by_sums)
      : material_(material), material_adjoint_(material_adjoint), step_(step), origin_(origin), nodes_(by_sums) {}

  template <class Count>
  JAXMPM_ONCE void reverse(const ParticleView<T, Dim>& p, std::size_t s, Count count, ParticleView<T, Dim>& bar, MaterialReport& report) {
    const typename Contract::template ContractStencil<G::with_d, G::with_g> t(p, s, count, origin_);
    alignas(64) typename Q::Stress sigma;
    Q q(p, s, count, material_, step_, sigma);
    Pack<T, W> gathered[G::padded];
    nodes_.template contract<G, Q>(t, s, count, q.value, gathered, bar);
    coefficients_adjoint<Sch>(p, s, count, q, sigma, gathered, material_, material_adjoint_, step_, bar, report);
  }

 private:
  const MaterialKernel<T, Dim>& material_;
  const MaterialAdjoint<T, Dim>& material_adjoint_;
  const StepConstants<T>& step_;
  const Index<Dim>& origin_;
  Contract nodes_;
};

/// Adjoint of particles to grid for particles [begin, end).
template <class Sch>
void p2g_adjoint_tile(const ParticleView<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end, P2gAdjoint<Sch> p2g,
                      ParticleView<typename Sch::T, Sch::Dim>& bar, MaterialReport& report) {
  for_each_batch<typename Sch::T>(begin, end, [&](std::size_t s, auto count) { p2g.reverse(p, s, count, bar, report); });
}

}  // namespace jaxmpm
