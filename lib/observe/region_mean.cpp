// Mean of a field over the material in a box, Σ w V f / Σ w V: w is the share of a particle's spline (one cell wide) that lies inside, so
// that the mean changes smoothly as material crosses the faces.
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
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    const std::size_t size = component_count(field_.rank, dim_);
    Sample sample{false, std::vector<double>(size, 0.0)};
    double volume = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const BodySnapshot& body = scene.bodies[b];
      for (std::size_t p = 0; p < body.id.size(); ++p) {
        const double share = inside(&body.position[p * dim_]) * body.mass[p] / body.density[p];
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

 private:
  double inside(const double* x) const {
    double share = 1;
    for (int a = 0; a < dim_ && share > 0; ++a) share *= spline_step((max_[a] - x[a]) / width_) - spline_step((min_[a] - x[a]) / width_);
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
