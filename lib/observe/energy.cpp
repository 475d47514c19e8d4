// Energy and where it went. Kinetic ½ Σ m v², potential −Σ m g·(x − x_min), strain energy of the materials, what was dissipated since the
// start, and the numerical remainder that closes the balance with the first reading.
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

class Energy : public Gauge {
 public:
  explicit Energy(const Model& model) : dim_(model.dim), gravity_(model.gravity), origin_(model.domain_min) {}
  std::vector<Channel> channels() const override {
    const std::vector<std::string> names{"kinetic", "potential", "strain", "plastic", "viscous", "friction", "numerical"};
    return {{"value", dim_ == 2 ? "J/m" : "J", {names.size()}, names}};
  }
  FieldSelection needs() const override {
    FieldSelection fields;
    fields.velocity = fields.energy = true;
    return fields;
  }
  Sample measure(const Scene& scene, const std::vector<double>* first) const override {
    double kinetic = 0, potential = 0, strain = 0;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.mass.size(); ++p) {
        for (int a = 0; a < dim_; ++a) {
          const double v = body.velocity[p * dim_ + a];
          kinetic += 0.5 * body.mass[p] * v * v;
          potential -= body.mass[p] * gravity_[a] * (body.position[p * dim_ + a] - origin_[a]);
        }
        strain += body.strain_energy[p];
      }
    const Dissipation& lost = scene.dissipation;
    double sum = kinetic + potential + strain + lost.plastic + lost.viscous + lost.friction;
    double start = sum;
    if (first) {
      start = 0;
      for (const double part : *first) start += part;
    }
    return {true, {kinetic, potential, strain, lost.plastic, lost.viscous, lost.friction, start - sum}};
  }

 private:
  int dim_;
  Point gravity_, origin_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::EnergyGauge&, const Model& model) { return std::make_unique<Energy>(model); }

}  // namespace jaxmpm
