// The device stepper, its very kernels run by the host's threads in teams of one, against the host stepper: same scenes, same results to
// round-off, and checkpoints that either continues.
#include <catch2/catch.hpp>

#include "device_scenes.hpp"
#include "kernels/device/scheme_impl.hpp"
#include "solvers/device_step_impl.hpp"
#include "solvers/explicit_step.hpp"

using namespace jaxmpm;

namespace {

const FieldSelection all_fields{true, true, true, true, true, true, true};

/// Largest difference of two fields over the largest value.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(std::abs(a[k] - b[k]) <= worst)) worst = std::abs(a[k] - b[k]);
    largest = std::max(largest, std::abs(b[k]));
  }
  return largest > 0 ? worst / largest : worst;
}

double difference(const Solver& one, const Solver& other) {
  const auto a = one.snapshot(all_fields, true), b = other.snapshot(all_fields, true);
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    REQUIRE(a[k].id == b[k].id);
    for (const auto field :
         {&BodySnapshot::position, &BodySnapshot::velocity, &BodySnapshot::density, &BodySnapshot::pressure, &BodySnapshot::stress,
          &BodySnapshot::velocity_gradient, &BodySnapshot::plastic_strain, &BodySnapshot::strain_energy})
      worst = std::max(worst, difference(a[k].*field, b[k].*field));
  }
  return worst;
}

double difference(const ContactForces& a, const ContactForces& b) {
  double worst = 0, largest = 0;
  const auto add = [&](const Point& x, const Point& y) {
    for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(x[c] - y[c])), largest = std::max(largest, std::abs(y[c]));
  };
  for (std::size_t f = 0; f < 6; ++f) add(a.face[f], b.face[f]);
  for (std::size_t o = 0; o < b.obstacle.size(); ++o) add(a.obstacle[o], b.obstacle[o]);
  REQUIRE(largest > 0);
  return worst / largest;
}

double total(const Dissipation& d) { return d.plastic + d.viscous + d.friction; }

/// Steps both steppers, through several sorts of each, and compares all that they show.
template <class Sch>
void compare(const Model& model) {
  using T = typename Sch::T;
  const double one_step = sizeof(T) == 4 ? 2e-5 : 1e-12, run = sizeof(T) == 4 ? 5e-3 : 1e-8, dt = 2e-4;
  ExplicitStep<T, Sch::Dim> host(model);
  DeviceStep<T, Sch::Dim, Host> device(model, device_detail::scheme_of<Sch, Host>());
  host.record_forces(true), device.record_forces(true);
  host.step(dt), device.step(dt);
  CHECK(difference(device, host) < one_step);
  CHECK(difference(device.forces(), host.forces()) < 10 * one_step);
  CHECK(total(device.dissipation()) == Approx(total(host.dissipation())).epsilon(10 * one_step));
  CHECK(device.stable_step() == Approx(host.stable_step()).epsilon(one_step));
  CHECK(device.active_blocks() == host.active_blocks());
  for (int k = 1; k < 60; ++k) host.step(dt), device.step(dt);
  const double found = difference(device, host);
  INFO("after 60 steps " << found);
  CHECK(found < run);
  host.restore(device.save());
  CHECK(difference(device, host) == 0);
  host.step(dt), device.step(dt);
  CHECK(difference(device, host) < one_step);
  device.restore(host.save());
  CHECK(difference(device, host) == 0);
}

const auto compare_scene = [](auto scheme, Model model) {
  model.account_energy = model.record_velocity_gradient = true;
  compare<decltype(scheme)>(model);
};

using Apic = Scheme<double, 2, 3, deck::Transfer::apic, false>;

}  // namespace

TEST_CASE("device stepper agrees with the host's in 2D") { for_each_device_scene_2d(compare_scene); }
TEST_CASE("device stepper agrees with the host's in 3D") { for_each_device_scene_3d(compare_scene); }
TEST_CASE("device stepper agrees with the host's where walls move and motion is damped") { for_each_driven_device_scene(compare_scene); }

TEST_CASE("device stepper agrees with the host's where a face holds particles") { for_creeping_device_scene(compare_scene); }

TEST_CASE("device stepper names the particle that leaves the domain") {
  const Model model = device_scene<Apic>(water(), sand(), deck::ContactKind::slip);
  DeviceStep<double, 2, Host> device(model, device_detail::scheme_of<Apic, Host>());
  CHECK_THROWS_WITH(device.step(0.5), Catch::Contains("particle ") && Catch::Contains("has left the domain"));
}

TEST_CASE("device stepper follows particles that cross several blocks in a step") {
  Model model = device_scene<Apic>(water(), sand(), deck::ContactKind::slip);
  model.cells = {80, 20, 1}, model.gravity = {}, model.obstacles.clear(), model.bodies.resize(1);
  BodyState& initial = model.bodies[0].initial;
  const double dt = 1e-4;
  for (std::size_t p = 0; p < initial.id.size(); ++p) {
    initial.position[p][0] += 4, initial.velocity[p] = {20 * model.cell_size / dt, 0, 0};
    initial.compression[p] = 0;
  }
  ExplicitStep<double, 2> host(model);
  DeviceStep<double, 2, Host> device(model, device_detail::scheme_of<Apic, Host>());
  for (int k = 0; k < 3; ++k) {
    host.step(dt), device.step(dt);  // 20 cells, two blocks and a half
    const BodySnapshot a = device.snapshot(all_fields, true).front(), b = host.snapshot(all_fields, true).front();
    CHECK(difference(a.position, b.position) < 1e-14);
    CHECK(difference(a.velocity, b.velocity) < 1e-13);
  }
}
