#pragma once
// Adjoint of the transfer from particles to grid: the reverse of a scatter is a gather, of the nodes' derivatives this time.
#include "kernels/adjoint/contract.hpp"
#include "kernels/adjoint/material_adjoint.hpp"

namespace jaxmpm {

/// Sums by place of W particles (one pack an axis): four lanes each, still to be added.
template <class Sch>
struct PlaceSums {
  using T = typename Sch::T;
  static constexpr int N = RowShape<T, Sch::S, Sch::V>::N, per_store = N / 4;
  static constexpr int padded = (Sch::Dim + per_store - 1) / per_store * per_store;
  ParticleRows<T, 4 * padded> rows;

  /// Takes the packs of one particle.
  JAXMPM_INLINE void put(int lane, const Pack<T, N>* sums) {
    for (int i = 0; i < padded; i += per_store) sum_groups<4>(sums + i).store(rows.row(lane) + 4 * i);
  }
  /// Adds them to the derivatives by position.
  JAXMPM_INLINE void add_to(Particles<T, Sch::Dim>& bar, std::size_t s, int count) {
    rows.clear_behind(count);
    Pack<T, batch<T>> packs[decltype(rows)::stride];
    rows.read(packs);
    for (int j = 0; j < Sch::Dim; ++j) {
      const auto sum = (packs[4 * j] + packs[4 * j + 1]) + (packs[4 * j + 2] + packs[4 * j + 3]);
      add_to_places(bar.position[std::size_t(j)].data() + s, count, sum);
    }
  }
};

/// The derivatives by a particle's groups of V values, gathered: per plane the value with w, then Dim with d and Dim with g as far as it has
/// them; and by its mass, where that is apart, in two parts.
template <class Sch>
struct GatheredBars {
  using Q = Coefficients<Sch>;
  static constexpr int Dim = Sch::Dim, V = Sch::V, per_store = RowShape<typename Sch::T, Sch::S, V>::N / V;
  static constexpr bool with_d = Sch::p2g_moments, with_g = Sch::p2g_slopes;
  static constexpr bool full(int plane) { return plane == (Sch::flip ? 1 : 0); }  // has more than the value
  static constexpr int size(int plane) { return full(plane) ? 1 + Dim * (int(with_d) + int(with_g)) : 1; }
  static constexpr int first(int plane) { return plane == 0 ? 0 : size(0); }
  static constexpr int force = first(Sch::flip ? 1 : 0) + 1 + (with_d && with_g ? Dim : 0);
  static constexpr int dilation = V * first(Sch::dilation_plane) + Sch::dilation_lane;
  static constexpr int mass = Sch::planes == 1 ? size(0) : size(0) + size(1);
  static constexpr int count = mass + int(V == 2), padded = (count + per_store - 1) / per_store * per_store;
};

/// Adjoint of Coefficients: what the gathered derivatives by a particle's coefficients bring to its fields.
template <class Sch>
JAXMPM_INLINE void coefficients_adjoint(const Particles<typename Sch::T, Sch::Dim>& p, std::size_t s, int count,
                                        const Pack<typename Sch::T, batch<typename Sch::T>>* gathered,
                                        const MaterialKernel<typename Sch::T, Sch::Dim>& material,
                                        const MaterialAdjoint<typename Sch::T, Sch::Dim>& material_adjoint,
                                        const StepConstants<typename Sch::T>& step, Particles<typename Sch::T, Sch::Dim>& bar,
                                        MaterialReport& report) {
  using T = typename Sch::T;
  using G = GatheredBars<Sch>;
  constexpr int W = batch<T>, Dim = Sch::Dim;
  using P = Pack<T, W>;
  const auto by_component = [&](int group, int c) { return gathered[G::V * group + Sch::vector_at + c]; };
  const auto add = [&](Array<T>& field, P value) { store(field.data() + s, load(field.data() + s, count) + value, count); };
  const P m = load(p.mass.data() + s, count);
  P by_mass = G::V == 2 ? gathered[2 * G::mass] + gathered[2 * G::mass + 1] : gathered[0];
  for (int c = 0; c < Dim; ++c) {
    by_mass += by_component(0, c) * load(p.velocity[std::size_t(c)].data() + s, count);
    add(bar.velocity[std::size_t(c)], m * by_component(0, c));
  }
  if constexpr (Sch::dilation)
    if (!p.dilation.empty()) {
      by_mass += gathered[G::dilation] * load(p.dilation[0].data() + s, count);
      add(bar.dilation[0], m * gathered[G::dilation]);
    }
  if constexpr (Sch::affine) {
    constexpr int first_moment = 1;
    const P size(step.cell_size);
    for (int c = 0; c < Dim; ++c)
      for (int k = 0; k < Dim; ++k) {
        const P by = size * by_component(first_moment + k, c);
        by_mass += by * load(p.affine[std::size_t(c * Dim + k)].data() + s, count);
        add(bar.affine[std::size_t(c * Dim + k)], m * by);
      }
  }
  alignas(64) T sigma[Symmetric<T, Dim>::size][W], by_sigma[Symmetric<T, Dim>::size][W];
  material.stress(p, s, count, sigma);
  const P e = load(p.compression.data() + s, count), growth = P(T(1)) / (P(T(1)) + e);
  const P per_mass = P(-step.dt * (Sch::gradient_scale / step.cell_size) / material.reference_density()) * growth, impulse = m * per_mass;
  P by_impulse(T(0)), by_stress[Symmetric<T, Dim>::size];
  for (P& b : by_stress) b = P(T(0));
  for (int c = 0; c < Dim; ++c)
    for (int k = 0; k < Dim; ++k) {
      const int at = Symmetric<T, Dim>::index(c, k);
      by_impulse += by_component(G::force + k, c) * P::load(sigma[at]);
      by_stress[at] += impulse * by_component(G::force + k, c);
    }
  by_mass += by_impulse * per_mass;
  add(bar.mass, by_mass);
  const P by_volume = by_impulse * impulse;
  add(bar.compression, -by_volume * growth);
  report.constants[0] -= sum_of(by_volume, count) / double(material.reference_density());
  for (int k = 0; k < Symmetric<T, Dim>::size; ++k) by_stress[k].store(by_sigma[k]);
  material_adjoint.stress(p, s, count, by_sigma, bar, report);
}

/// Adjoint of p2g_tile, a batch after the other: adds to `bar` what the derivatives by the nodes' sums, in `arena` ({m̄, p̄}, and {–, impulse}
/// of a second plane), bring.
template <class Sch>
class P2gAdjoint {
  using T = typename Sch::T;
  using Q = Coefficients<Sch>;
  using G = GatheredBars<Sch>;
  using Rows = StencilRows<Sch, true>;
  static constexpr int Dim = Sch::Dim, W = batch<T>;

 public:
  P2gAdjoint(const MaterialKernel<T, Dim>& material, const MaterialAdjoint<T, Dim>& material_adjoint, const StepConstants<T>& step,
             const Index<Dim>& origin, const T* arena)
      : material_(material), material_adjoint_(material_adjoint), step_(step), origin_(origin), arena_(arena) {
    for (auto& r : rows_) r.clear();
  }

  template <class Count>
  JAXMPM_ONCE void reverse(const Particles<T, Dim>& p, std::size_t s, Count count, Particles<T, Dim>& bar, MaterialReport& report) {
    using R = typename Rows::R;
    const Stencils<Sch, G::with_d, G::with_g, true> t(p, s, count, origin_);
    const Q q(p, s, count, material_, step_);
    ParticleRows<T, G::V * G::padded> gathered;
    PlaceSums<Sch> by_place;
    for (int l = 0; l < count; ++l) {
      load_rows(rows_, arena_, t.base[l], loaded_);
      R sums[G::padded], place[PlaceSums<Sch>::padded];
      for (int i = G::count; i < G::padded; ++i) sums[i] = R(T(0));
      for (R& x : place) x = R(T(0));
      static_for<Sch::planes>([&](auto plane) JAXMPM_INLINE_LAMBDA {
        constexpr bool full = G::full(plane);
        constexpr PlaneQuads of = Q::in_plane(plane);
        static_assert((full && G::with_d) == (of.moments >= 0) && (full && G::with_g) == (of.slopes >= 0));
        contract<Sch, of.rest, of.moments, of.slopes>(rows_[plane], t, l, q.rows.row(l), place, sums + G::first(plane));
      });
      if constexpr (G::V == 2) contract_mass<Sch>(rows_[0], t, l, q.mass[l], place, sums[G::mass]);
      for (int i = 0; i < G::padded; i += G::per_store) sum_groups<G::V>(sums + i).store(gathered.row(l) + G::V * i);
      by_place.put(l, place);
    }
    gathered.clear_behind(count);
    Pack<T, W> packs[decltype(gathered)::stride];
    gathered.read(packs);
    by_place.add_to(bar, s, count);
    coefficients_adjoint<Sch>(p, s, count, packs, material_, material_adjoint_, step_, bar, report);
  }

 private:
  const MaterialKernel<T, Dim>& material_;
  const MaterialAdjoint<T, Dim>& material_adjoint_;
  const StepConstants<T>& step_;
  const Index<Dim>& origin_;
  const T* arena_;
  Rows rows_[Sch::planes];
  int loaded_ = -1;  // base node of rows_
};

/// Adjoint of particles to grid for particles [begin, end).
template <class Sch>
void p2g_adjoint_tile(const Particles<typename Sch::T, Sch::Dim>& p, std::size_t begin, std::size_t end, P2gAdjoint<Sch> p2g,
                      Particles<typename Sch::T, Sch::Dim>& bar, MaterialReport& report) {
  for_each_batch<typename Sch::T>(begin, end, [&](std::size_t s, auto count) { p2g.reverse(p, s, count, bar, report); });
}

}  // namespace jaxmpm
