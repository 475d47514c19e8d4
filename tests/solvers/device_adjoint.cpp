// The device stepper's adjoint, its very kernels run by the host's threads in teams of one, against the host's: the same scenes, the same
// gradients to round-off.
#include <catch2/catch.hpp>

#include "device_scenes.hpp"
#include "kernels/device/adjoint/scheme_impl.hpp"
#include "solvers/device_reversible_step_impl.hpp"
#include "solvers/reversible_step.hpp"

using namespace jaxmpm;

namespace {

constexpr int steps = 40;
constexpr double dt = 2e-4;

/// A loss that asks for every field of every particle, with random weights of about the fields' own size.
SnapshotGradient random_loss(const Model& model, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SnapshotGradient by;
  for (const Body& body : model.bodies) {
    BodySnapshot& b = by.emplace_back();
    const std::size_t n = body.initial.id.size(), dim = std::size_t(model.dim);
    const auto fill = [&](std::vector<double>& field, std::size_t size, double scale) {
      field.resize(size);
      for (double& x : field) x = normal(random) / scale;
    };
    fill(b.position, n * dim, model.cell_size), fill(b.velocity, n * dim, 1), fill(b.mass, n, 0.1), fill(b.density, n, 1);
    fill(b.stress, 6 * n, 1e3), fill(b.plastic_strain, n, 1);
  }
  return by;
}

/// Runs forward and back, with losses on the last state and on one halfway.
template <class Stepper>
ModelGradient gradient_of(Stepper& stepper, const Model& model, std::size_t& kinks) {
  std::vector<std::vector<std::byte>> numbers;
  std::vector<std::unique_ptr<KeptState>> kept;
  for (int k = 0; k < steps; ++k) {
    numbers.emplace_back(stepper.kept_bytes());
    kept.push_back(stepper.keep(numbers.back().data(), false));
    stepper.step(dt);
  }
  stepper.start_reverse();
  stepper.add_gradient(random_loss(model, 1));
  for (std::size_t k = steps; k-- > 0;) {
    stepper.step_adjoint(dt, *kept[k], numbers[k].data());
    stepper.go_back(*kept[k], numbers[k].data());
    if (k == steps / 2) stepper.add_gradient(random_loss(model, 2));
  }
  stepper.end_reverse();
  kinks = stepper.at_kinks();
  return stepper.gradient();
}

/// All numbers of a gradient of one kind, and their largest difference over the largest of them.
struct Numbers {
  std::vector<double> a, b;
  void add(double x, double y) { a.push_back(x), b.push_back(y); }
  template <class V, std::size_t n>
  void add(const std::array<V, n>& x, const std::array<V, n>& y) {
    for (std::size_t k = 0; k < n; ++k) add(x[k], y[k]);
  }
  template <class V>
  void add(const std::vector<V>& x, const std::vector<V>& y) {
    REQUIRE(x.size() == y.size());
    for (std::size_t k = 0; k < x.size(); ++k) add(x[k], y[k]);
  }
  double difference() const {
    double worst = 0, largest = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (!(std::abs(a[k] - b[k]) <= worst)) worst = std::abs(a[k] - b[k]);
      largest = std::max(largest, std::abs(b[k]));
    }
    return largest > 0 ? worst / largest : worst;
  }
};

void compare(const ModelGradient& device, const ModelGradient& host, bool damped, double most) {
  const auto near = [&](const char* what, const auto& x, const auto& y) {
    Numbers n;
    n.add(x, y);
    INFO(what << ": " << n.difference());
    CHECK(n.difference() < most);
  };
  near("gravity", device.gravity, host.gravity);
  if (damped) near("damping", device.damping, host.damping);  // else nobody asks for it
  near("flip_fraction", device.flip_fraction, host.flip_fraction);
  near("obstacles", device.obstacle_coefficient, host.obstacle_coefficient);
  near("walls", device.wall_velocity, host.wall_velocity);
  for (std::size_t f = 0; f < 6; ++f) near("segments", device.coefficient[f], host.coefficient[f]);
  for (std::size_t b = 0; b < host.bodies.size(); ++b) {
    near("velocity", device.bodies[b].initial.velocity, host.bodies[b].initial.velocity);
    near("mass", device.bodies[b].initial.mass, host.bodies[b].initial.mass);
    near("compression", device.bodies[b].initial.compression, host.bodies[b].initial.compression);
    near("stress", device.bodies[b].initial.stress, host.bodies[b].initial.stress);
    for (const auto& [key, value] : host.bodies[b].material) near(key.c_str(), device.bodies[b].material.at(key), value);
  }
}

template <class Sch>
void compare(const Model& model) {
  using T = typename Sch::T;
  ReversibleStep<T, Sch::Dim> host(model);
  DeviceReversibleStep<T, Sch::Dim, Host> device(model, device_detail::scheme_of<Sch, Host>(), device_detail::adjoint_of<Sch, Host>());
  std::size_t host_kinks, device_kinks;
  const ModelGradient by_host = gradient_of(host, model, host_kinks), by_device = gradient_of(device, model, device_kinks);
  compare(by_device, by_host, model.method.damping > 0, sizeof(T) == 4 ? 2e-2 : 1e-7);
  if (sizeof(T) == 8) CHECK(device_kinks == host_kinks);
}

const auto compare_scene = [](auto scheme, const Model& model) { compare<decltype(scheme)>(model); };

}  // namespace

TEST_CASE("the adjoint on a device agrees with the host's in 2D") { for_each_device_scene_2d(compare_scene); }
TEST_CASE("the adjoint on a device agrees with the host's in 3D") { for_each_device_scene_3d(compare_scene); }
TEST_CASE("the adjoint on a device agrees with the host's where walls move and motion is damped") {
  for_each_driven_device_scene(compare_scene);
}
TEST_CASE("the adjoint on a device agrees with the host's where a face holds particles") { for_creeping_device_scene(compare_scene); }
