#pragma once
// What the device's kernels are compared with the host's on: all transfers, bases and materials, in both dimensions and precisions.
#include <catch2/catch.hpp>

#include "kernels/scheme.hpp"
#include "scenes.hpp"

namespace jaxmpm {

template <class Sch>
Model device_scene(const deck::Material& first, const deck::Material& second, deck::ContactKind kind) {
  deck::Method method;
  method.transfer = Sch::transfer, method.gradient = Sch::mls ? deck::GradientForm::mls : deck::GradientForm::spline;
  method.basis = Sch::S == 2 ? deck::Basis::linear : (Sch::S == 3 ? deck::Basis::quadratic : deck::Basis::cubic);
  method.precision = sizeof(typename Sch::T) == 4 ? deck::Precision::f32 : deck::Precision::f64;
  return busy_scene(Sch::Dim, method, first, second, kind);
}

/// Calls f(scheme, model) with the model of a scheme, two materials and a kind of contact.
template <class F>
auto with_scene(const F& f) {
  return [&f](auto scheme, const deck::Material& first, const deck::Material& second, deck::ContactKind kind) {
    f(scheme, device_scene<decltype(scheme)>(first, second, kind));
  };
}

/// A section for each scene: f(scheme, model).
template <class F>
void for_each_device_scene_2d(const F& f) {
  using deck::Transfer;
  using Kind = deck::ContactKind;
  const auto section = with_scene(f);
  SECTION("APIC, quadratic, friction") { section(Scheme<double, 2, 3, Transfer::apic, false>{}, water(), sand(), Kind::friction); }
  SECTION("FLIP, quadratic, friction") { section(Scheme<double, 2, 3, Transfer::flip, false>{}, water(2), sand(), Kind::friction); }
  SECTION("TPIC, linear, no_slip") { section(Scheme<double, 2, 2, Transfer::tpic, false>{}, water(), rubber(), Kind::no_slip); }
  SECTION("PIC, cubic, mls, slip") { section(Scheme<double, 2, 4, Transfer::pic, true>{}, sand(), elastic(), Kind::slip); }
}
template <class F>
void for_each_device_scene_3d(const F& f) {
  using deck::Transfer;
  using Kind = deck::ContactKind;
  const auto section = with_scene(f);
  SECTION("APIC, quadratic, mls, friction") { section(Scheme<double, 3, 3, Transfer::apic, true>{}, water(), sand(), Kind::friction); }
  SECTION("FLIP, cubic, separate") { section(Scheme<double, 3, 4, Transfer::flip, false>{}, water(2), rubber(), Kind::separate); }
  SECTION("APIC, quadratic, single precision") { section(Scheme<float, 3, 3, Transfer::apic, false>{}, water(), sand(), Kind::friction); }
}
/// Particles that a face holds.
template <class F>
void for_creeping_device_scene(const F& f) {
  using Sch = Scheme<double, 2, 3, deck::Transfer::apic, false>;
  f(Sch{}, creeping_scene(2, device_scene<Sch>(water(), sand(), deck::ContactKind::separate).method));
}
/// Walls that move, and damping.
template <class F>
void for_each_driven_device_scene(const F& f) {
  using Sch = Scheme<double, 2, 3, deck::Transfer::flip, false>;
  for (const auto kind : {deck::ContactKind::no_slip, deck::ContactKind::friction}) {
    Model model = driven(device_scene<Sch>(water(2), sand(), kind));
    model.body_force = nullptr;  // the host's alone
    f(Sch{}, model);
  }
}

}  // namespace jaxmpm
