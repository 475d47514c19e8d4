// Energy and where it went. Kinetic ½ Σ m v², potential −Σ m g·(x − x_min), strain energy of the materials, what was dissipated since the
// start, and the numerical remainder that closes the balance with the first reading.
#include "core/parallel_host.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

/// Of some particles, J.
struct Held {
  double kinetic = 0, potential = 0, strain = 0;
};

class Energy : public Gauge {
 public:
  explicit Energy(const Model& model) : dim_(model.dim), gravity_(model.gravity), origin_(model.domain_min) {}
  std::vector<Channel> channels() const override {
    const std::vector<std::string> names{"kinetic", "potential", "strain", "plastic", "viscous", "friction", "numerical"};
    return {{"value", dim_ == 2 ? "J/m" : "J", {names.size()}, names}};
  }
  bool uses_all_threads() const override { return true; }
  FieldSelection needs() const override {
    FieldSelection fields;
    fields.velocity = fields.energy = true;
    return fields;
  }
  Sample measure(const Scene& scene, const std::vector<double>* first) const override {
    Held all;
    for (const BodySnapshot& body : scene.bodies)
      for (const Held& part :
           in_pieces("jaxmpm::energy", body.mass.size(), [&](std::size_t begin, std::size_t end) { return held_by(body, begin, end); }))
        all.kinetic += part.kinetic, all.potential += part.potential, all.strain += part.strain;
    const Dissipation& lost = scene.dissipation;
    double sum = all.kinetic + all.potential + all.strain + lost.plastic + lost.viscous + lost.friction;
    double start = sum;
    if (first) {
      start = 0;
      for (const double part : *first) start += part;
    }
    return {true, {all.kinetic, all.potential, all.strain, lost.plastic, lost.viscous, lost.friction, start - sum}};
  }

 private:
  Held held_by(const BodySnapshot& body, std::size_t begin, std::size_t end) const {
    Held sum;
    for (std::size_t p = begin; p < end; ++p) {
      double square = 0, work = 0;
      for (int a = 0; a < dim_; ++a) {
        const double v = body.velocity[p * dim_ + a];
        square += v * v, work += gravity_[a] * (body.position[p * dim_ + a] - origin_[a]);
      }
      sum.kinetic += 0.5 * body.mass[p] * square, sum.potential -= body.mass[p] * work, sum.strain += body.strain_energy[p];
    }
    return sum;
  }

  int dim_;
  Point gravity_, origin_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::EnergyGauge&, const Model& model) { return std::make_unique<Energy>(model); }

}  // namespace jaxmpm
