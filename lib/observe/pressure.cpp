// Pressure near a point: the mean over material within 1.5 cells, Σ V φ p / Σ V φ with the quadratic spline φ around the point.
#include "observe/gauges.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

class Pressure : public Gauge {
 public:
  Pressure(const deck::PressureGauge& gauge, const Model& model) : at_(gauge.at), dim_(model.dim), width_(model.cell_size) {}
  std::vector<Channel> channels() const override { return {{"value", "Pa", {}, {}}}; }
  FieldSelection needs() const override { return selection({"pressure", "density"}); }
  std::optional<Region> region() const override { return around(at_, at_, reach * width_); }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    double sum = 0, volume = 0;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.id.size(); ++p) {
        const double own = share(body, p);
        volume += own;
        sum += own * body.pressure[p];
      }
    return volume > 0 ? Sample{true, {sum / volume}} : Sample{};
  }
  /// With s = V φ: d(Σ s p / Σ s) = Σ (s dp + (p − value) ds) / Σ s.
  void gradient(const Scene& scene, const Sample& reading, const double* by_values, SnapshotGradient& into) const override {
    double volume = 0;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.id.size(); ++p) volume += share(body, p);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const BodySnapshot& body = scene.bodies[b];
      const std::size_t n = body.id.size();
      double* by_mass = gradient_of(&BodySnapshot::mass, into[b], n);
      double* by_density = gradient_of(&BodySnapshot::density, into[b], n);
      double* by_position = gradient_of(&BodySnapshot::position, into[b], n * dim_);
      for (std::size_t p = 0; p < n; ++p) {
        const double own = share(body, p), by_share = by_values[0] * (body.pressure[p] - reading.values[0]) / volume;
        if (own <= 0) continue;
        by_mass[p] += by_share * own / body.mass[p];
        by_density[p] -= by_share * own / body.density[p];
        for (int a = 0; a < dim_; ++a) {
          const double r = (body.position[p * dim_ + a] - at_[a]) / width_;
          by_position[p * dim_ + a] += by_share * own * spline_slope(r) / (spline(r) * width_);
        }
        add_field_gradient(output_field("pressure"), by_values[0] * own / volume, p, 0, 1, n, into[b]);
      }
    }
  }

 private:
  /// V φ of a particle.
  double share(const BodySnapshot& body, std::size_t p) const {
    double share = 1;
    for (int a = 0; a < dim_; ++a) {
      const double r = (body.position[p * dim_ + a] - at_[a]) / width_;
      if (!(std::abs(r) < reach)) return 0;  // most of them
      share *= spline(r);
    }
    return share * body.mass[p] / body.density[p];
  }

  deck::Numbers at_;
  int dim_;
  double width_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::PressureGauge& gauge, const Model& model) { return std::make_unique<Pressure>(gauge, model); }

}  // namespace jaxmpm
