// Mean of a field over the material in a box, Σ w V f / Σ w V: w is the share of a particle's spline (one cell wide) that lies inside, so
// that the mean changes smoothly as material crosses the faces.
#include <algorithm>

#include "observe/gauges.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

class RegionMean : public Gauge {
 public:
  RegionMean(const deck::RegionMeanGauge& gauge, const Model& model)
      : field_(output_field(gauge.field)), dim_(model.dim), min_(gauge.min), max_(gauge.max), width_(model.cell_size) {}
  std::vector<Channel> channels() const override {
    std::vector<std::string> names = component_names(field_.rank, dim_);
    return {{"value", field_.unit, names.empty() ? std::vector<std::size_t>{} : std::vector<std::size_t>{names.size()}, names}};
  }
  FieldSelection needs() const override { return selection({field_.name, "density"}); }
  std::optional<Region> region() const override { return around(min_, max_, reach * width_); }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    const std::size_t size = component_count(field_.rank, dim_);
    Sample sample{false, std::vector<double>(size, 0.0)};
    double volume = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const BodySnapshot& body = scene.bodies[b];
      for (std::size_t p = 0; p < body.id.size(); ++p) {
        const double share = share_of(body, p);
        if (share <= 0) continue;
        volume += share;
        for (std::size_t k = 0; k < size; ++k) sample.values[k] += share * field_value(field_, body, b, p, k, size);
      }
    }
    sample.valid = volume > 0;
    if (sample.valid)
      for (double& value : sample.values) value /= volume;
    return sample;
  }
  /// With s = w V: d(Σ s f / Σ s) = Σ (s df + (f − value) ds) / Σ s.
  void gradient(const Scene& scene, const Sample& reading, const double* by_values, SnapshotGradient& into) const override {
    if (!has_derivative(field_)) Gauge::gradient(scene, reading, by_values, into);
    const std::size_t size = reading.values.size();
    double volume = 0;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.id.size(); ++p) volume += std::max(0.0, share_of(body, p));
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      for (std::size_t p = 0, n = scene.bodies[b].id.size(); p < n; ++p) {
        const double share = share_of(scene.bodies[b], p);
        if (share <= 0) continue;
        double by_share = 0;
        for (std::size_t k = 0; k < size; ++k) {
          by_share += by_values[k] * (field_value(field_, scene.bodies[b], b, p, k, size) - reading.values[k]) / volume;
          add_field_gradient(field_, by_values[k] * share / volume, p, k, size, n, into[b]);
        }
        add_share_gradient(scene.bodies[b], p, share, by_share, into[b]);
      }
  }

 private:
  double share_of(const BodySnapshot& body, std::size_t p) const {
    return inside(&body.position[p * dim_]) * body.mass[p] / body.density[p];
  }
  /// Part of the spline around coordinate x that lies inside along an axis, and its derivative.
  double inside(int a, double x) const { return spline_step((max_[a] - x) / width_) - spline_step((min_[a] - x) / width_); }
  double inside_slope(int a, double x) const { return (spline((min_[a] - x) / width_) - spline((max_[a] - x) / width_)) / width_; }
  void add_share_gradient(const BodySnapshot& body, std::size_t p, double share, double by_share, BodySnapshot& into) const {
    const std::size_t n = body.id.size();
    gradient_of(&BodySnapshot::mass, into, n)[p] += by_share * share / body.mass[p];
    gradient_of(&BodySnapshot::density, into, n)[p] -= by_share * share / body.density[p];
    double* by_position = gradient_of(&BodySnapshot::position, into, n * dim_);
    for (int a = 0; a < dim_; ++a) {
      const double x = body.position[p * dim_ + a];
      by_position[p * dim_ + a] += by_share * share * inside_slope(a, x) / inside(a, x);
    }
  }
  double inside(const double* x) const {
    double share = 1;
    for (int a = 0; a < dim_ && share > 0; ++a) share *= inside(a, x[a]);
    return share;
  }

  const OutputField& field_;
  int dim_;
  deck::Numbers min_, max_;
  double width_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::RegionMeanGauge& gauge, const Model& model) {
  return std::make_unique<RegionMean>(gauge, model);
}

}  // namespace jaxmpm
