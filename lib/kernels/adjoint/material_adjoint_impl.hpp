#pragma once
// The adjoint of any law (lib/materials): by hand where it has one, else by a tape of its own update (core/tape.hpp).
#include "core/tape.hpp"
#include "kernels/adjoint/material_adjoint.hpp"
#include "kernels/batch.hpp"
#include "materials/registry.hpp"

namespace jaxmpm {

template <class T, int Dim, template <class> class Law>
class LawAdjoint final : public MaterialAdjoint<T, Dim> {
  static constexpr int W = batch<T>, history = Law<T>::template history_size<Dim>(), slots = history > 0 ? history : 1;
  using P = Pack<T, W>;
  using Real = Taped<P>;
  static constexpr int constants = int(std::tuple_size_v<decltype(Law<T>::constants(std::declval<Law<T>&>()))>);
  static_assert(constants <= MaterialReport::most_constants);
  Law<T> law_;

  /// The particles' compression and history as inputs of the tape, with their derivatives by the end of the step.
  struct Inputs {
    Real e, h[slots];
    Inputs(const ParticleView<T, Dim>& p, std::size_t s, int count) : e(Real::input(load(p.compression.data() + s, count))) {
      for (int k = 0; k < history; ++k) h[k] = Real::input(load(p.history[std::size_t(k)].data() + s, count));
    }
  };
  /// The law with its constants as inputs of the tape.
  Law<Real> taped_law() const {
    Law<Real> law;
    const auto from = Law<T>::constants(law_);
    const auto to = Law<Real>::constants(law);
    for (std::size_t k = 0; k < from.size(); ++k) *to[k] = Real::input(P(*from[k]));
    return law;
  }
  static void add(Law<Real>& law, int count, MaterialReport& report) {
    const auto all = Law<Real>::constants(law);
    for (std::size_t k = 0; k < all.size(); ++k) {
      report.constants[k] += sum_of(P(Real::tape().derivative(all[k]->node)), count);
    }
  }
  /// Derivatives by `count` particles, zero in the lanes behind them.
  static P seed(const FieldView<T>& field, std::size_t s, int count) { return load_zeros_behind(field.data() + s, count); }

 public:
  explicit LawAdjoint(const Law<T>& law) : law_(law) {}

  void update(const ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][W], T dt, ParticleView<T, Dim>& bar, T by_H[][W],
              MaterialReport& report) const override {
    if constexpr (Law<T>::by_hand) update_by_hand(p, s, count, H, dt, bar, by_H, report);
    else update_by_tape(p, s, count, H, dt, bar, by_H, report);
  }
  void update_by_tape(const ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][W], T dt, ParticleView<T, Dim>& bar, T by_H[][W],
                      MaterialReport& report) const {
    Tape<P>& tape = Real::tape();
    tape.clear();
    const Inputs start(p, s, count);
    Law<Real> law = taped_law();
    Matrix<Real, Dim> increment;
    for (int k = 0; k < Dim * Dim; ++k) increment.a[k] = Real::input(P::load(H[k]));
    Real e = start.e, h[slots];
    for (int k = 0; k < history; ++k) h[k] = start.h[k];
    law.template update<Real, Dim>(increment, Real(dt), e, h);
    tape.seed(e.node, seed(bar.compression, s, count));
    for (int k = 0; k < history; ++k) tape.seed(h[k].node, seed(bar.history[std::size_t(k)], s, count));
    tape.sweep();
    store(bar.compression.data() + s, tape.derivative(start.e.node), count);
    for (int k = 0; k < history; ++k) store(bar.history[std::size_t(k)].data() + s, tape.derivative(start.h[k].node), count);
    for (int k = 0; k < Dim * Dim; ++k) tape.derivative(increment.a[k].node).store(by_H[k]);
    add(law, count, report);
    for (int l = 0; l < count; ++l) report.at_kinks += tape.ties().m[l] != 0;
  }

  void stress(const ParticleView<T, Dim>& p, std::size_t s, int count, const T by_sigma[][W], ParticleView<T, Dim>& bar,
              MaterialReport& report) const override {
    if constexpr (Law<T>::by_hand) stress_by_hand(p, s, count, by_sigma, bar, report);
    else stress_by_tape(p, s, count, by_sigma, bar, report);
  }
  void stress_by_tape(const ParticleView<T, Dim>& p, std::size_t s, int count, const T by_sigma[][W], ParticleView<T, Dim>& bar,
                      MaterialReport& report) const {
    Tape<P>& tape = Real::tape();
    tape.clear();
    const Inputs start(p, s, count);
    Law<Real> law = taped_law();
    const Symmetric<Real, Dim> sigma = law.template stress<Real, Dim>(start.e, start.h);
    for (int k = 0; k < sigma.size; ++k) {
      tape.seed(sigma[k].node, load_zeros_behind(by_sigma[k], count));
    }
    tape.sweep();
    const auto add_to = [&](FieldView<T>& field, int node) {
      store(field.data() + s, load(field.data() + s, count) + tape.derivative(node), count);
    };
    add_to(bar.compression, start.e.node);
    for (int k = 0; k < history; ++k) add_to(bar.history[std::size_t(k)], start.h[k].node);
    add(law, count, report);
  }

  void start(const Particles<T, Dim>& p, const Particles<T, Dim>& bar, double* by_compression, double* by_stress,
             MaterialReport& report) const override {
    const ParticleView<T, Dim> first(p), by(bar);
    for (std::size_t s = 0; s < p.count(); s += W) {
      const int count = int(std::min<std::size_t>(W, p.count() - s));
      start_batch(first, s, count, by, by_compression + s, by_stress + 6 * s, report);
    }
  }

 private:
  /// Values of `count` particles, and the derivatives by them (zero in the lanes behind).
  struct Batch {
    P e, h[slots], by_e, by_h[slots], by_constants[constants];
    Batch(const ParticleView<T, Dim>& p, const ParticleView<T, Dim>& bar, std::size_t s, int count) {
      e = load(p.compression.data() + s, count), by_e = seed(bar.compression, s, count);
      for (int k = 0; k < history; ++k) {
        h[k] = load(p.history[std::size_t(k)].data() + s, count);
        by_h[k] = seed(bar.history[std::size_t(k)], s, count);
      }
      for (P& c : by_constants) c = P(T(0));
    }
    void store_to(ParticleView<T, Dim>& bar, std::size_t s, int count, MaterialReport& report) const {
      jaxmpm::store(bar.compression.data() + s, by_e, count);
      for (int k = 0; k < history; ++k) jaxmpm::store(bar.history[std::size_t(k)].data() + s, by_h[k], count);
      for (int k = 0; k < constants; ++k) report.constants[std::size_t(k)] += sum_of(by_constants[k], count);
    }
  };
  void update_by_hand(const ParticleView<T, Dim>& p, std::size_t s, int count, const T H[][W], T dt, ParticleView<T, Dim>& bar, T by_H[][W],
                      MaterialReport& report) const {
    Batch b(p, bar, s, count);
    Matrix<P, Dim> increment, by_increment;
    for (int k = 0; k < Dim * Dim; ++k) increment.a[k] = P::load(H[k]);
    const auto kink = law_.template update_adjoint<P, Dim>(increment, P(dt), b.e, b.h, b.by_e, b.by_h, by_increment, b.by_constants);
    for (int l = 0; l < count; ++l) report.at_kinks += kink.m[l] != 0;
    for (int k = 0; k < Dim * Dim; ++k) by_increment.a[k].store(by_H[k]);
    b.store_to(bar, s, count, report);
  }
  void stress_by_hand(const ParticleView<T, Dim>& p, std::size_t s, int count, const T by_sigma[][W], ParticleView<T, Dim>& bar,
                      MaterialReport& report) const {
    Batch b(p, bar, s, count);
    Symmetric<P, Dim> by;
    for (int k = 0; k < by.size; ++k) by[k] = P::load(by_sigma[k]);
    law_.template stress_adjoint<P, Dim>(b.e, b.h, by, b.by_e, b.by_h, b.by_constants);
    b.store_to(bar, s, count, report);
  }

  void start_batch(const ParticleView<T, Dim>& p, std::size_t s, int count, const ParticleView<T, Dim>& bar, double* by_compression,
                   double* by_stress, MaterialReport& report) const {
    P h[slots];
    for (int k = 0; k < history; ++k) h[k] = load(p.history[std::size_t(k)].data() + s, count);
    const P compression = load(p.compression.data() + s, count);
    const Symmetric<P, Dim> stress = law_.template stress<P, Dim>(compression, h);  // what the state was started from
    Tape<P>& tape = Real::tape();
    tape.clear();
    Law<Real> law = taped_law();
    Symmetric<Real, Dim> sigma;
    for (int k = 0; k < sigma.size; ++k) sigma[k] = Real::input(stress[k]);
    const Real e = Real::input(compression);
    Real started[slots];
    law.template start<Real, Dim>(sigma, e, started);
    for (int k = 0; k < history; ++k) tape.seed(started[k].node, seed(bar.history[std::size_t(k)], s, count));
    tape.sweep();
    for (int l = 0; l < count; ++l) {
      by_compression[l] = double(bar.compression.data()[s + std::size_t(l)]) + double(tape.derivative(e.node)[l]);
      for (int k = 0; k < sigma.size; ++k) by_stress[6 * l + k] = double(tape.derivative(sigma[k].node)[l]);
    }
    add(law, count, report);
  }
};

namespace material_detail {
template <class T, int Dim, template <class> class Law>
std::unique_ptr<MaterialAdjoint<T, Dim>> make_adjoint(const Law<T>& law) {
  return std::make_unique<LawAdjoint<T, Dim, Law>>(law);
}
}  // namespace material_detail

template <class T, int Dim>
std::unique_ptr<MaterialAdjoint<T, Dim>> make_material_adjoint(const deck::Material& material) {
  return with_law<T>(material, [](const auto& law) { return material_detail::make_adjoint<T, Dim>(law); });
}

}  // namespace jaxmpm
