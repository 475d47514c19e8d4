// Snapshots of regions: all particles there, with the very values of a whole snapshot and in its order, on the host and on a device.
#include <catch2/catch.hpp>

#include "kernels/device/scheme_impl.hpp"
#include "scenes.hpp"
#include "solvers/device_step_impl.hpp"
#include "solvers/explicit_step.hpp"

using namespace jaxmpm;

namespace {

const FieldSelection fields{true, true, true, true, true, true, true};

bool inside(const Region& region, const double* x, int dim) {
  for (int d = 0; d < dim; ++d)
    if (x[d] < region.min[std::size_t(d)] || x[d] > region.max[std::size_t(d)]) return false;
  return true;
}

/// Rows of a field that have the given width, of the chosen particles.
std::vector<double> rows(const std::vector<double>& field, std::size_t width, const std::vector<std::size_t>& chosen) {
  std::vector<double> out;
  for (const std::size_t p : chosen)
    out.insert(out.end(), field.begin() + std::ptrdiff_t(p * width), field.begin() + std::ptrdiff_t((p + 1) * width));
  return out;
}

/// The part of a whole snapshot that a snapshot of regions shows has its values; nothing inside the regions is missing.
void compare(const Model& model, const Solver& solver, const std::vector<Region>& regions) {
  const auto whole = solver.snapshot(fields, false), part = solver.snapshot_within(regions, fields);
  REQUIRE(part.size() == whole.size());
  const std::size_t dim = std::size_t(model.dim);
  for (std::size_t b = 0; b < whole.size(); ++b) {
    std::vector<std::size_t> shown;
    std::size_t next = 0, missing = 0;
    for (std::size_t p = 0; p < whole[b].id.size(); ++p) {
      if (next < part[b].id.size() && part[b].id[next] == whole[b].id[p]) {
        shown.push_back(p), ++next;
        continue;
      }
      for (const Region& region : regions) missing += inside(region, &whole[b].position[p * dim], model.dim);
    }
    CHECK(missing == 0);
    REQUIRE(shown.size() == part[b].id.size());  // in the same order
    CHECK(part[b].position == rows(whole[b].position, dim, shown));
    CHECK(part[b].velocity == rows(whole[b].velocity, dim, shown));
    CHECK(part[b].stress == rows(whole[b].stress, 6, shown));
    CHECK(part[b].strain_energy == rows(whole[b].strain_energy, 1, shown));
  }
}

template <class Sch>
void compare(deck::Basis basis, Model model) {
  constexpr int Dim = Sch::Dim;
  model.method.basis = basis;
  ExplicitStep<double, Dim> host(model);
  DeviceStep<double, Dim, Host> device(model, device_detail::scheme_of<Sch, Host>());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> part(0, 1);
  for (int k = 0; k < 50; ++k) {
    std::vector<Region> regions(2);
    for (Region& region : regions)
      for (std::size_t d = 0; d < std::size_t(Dim); ++d) {
        const double extent = model.cells[d] * model.cell_size, at = model.domain_min[d] + extent * part(random);
        region.min[d] = at, region.max[d] = at + 0.2 * extent * part(random);
      }
    host.step(2e-4), device.step(2e-4);
    compare(model, host, regions), compare(model, device, regions);
  }
  CHECK(host.snapshot_within({}, fields)[0].id.empty());
  CHECK(device.snapshot_within({}, fields)[0].id.empty());
}

Model scene(int dim, deck::Basis basis) {
  deck::Method method;
  method.basis = basis, method.precision = deck::Precision::f64;
  return busy_scene(dim, method, water(), sand(), deck::ContactKind::slip);
}

}  // namespace

TEST_CASE("snapshots of regions hold all that is there") {
  using deck::Basis;
  using deck::Transfer;
  compare<Scheme<double, 2, 2, Transfer::tpic, false>>(Basis::linear, scene(2, Basis::linear));
  compare<Scheme<double, 2, 3, Transfer::apic, false>>(Basis::quadratic, scene(2, Basis::quadratic));
  compare<Scheme<double, 3, 4, Transfer::apic, false>>(Basis::cubic, scene(3, Basis::cubic));
}
