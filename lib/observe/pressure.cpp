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
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    double sum = 0, volume = 0;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.id.size(); ++p) {
        double share = body.mass[p] / body.density[p];
        for (int a = 0; a < dim_; ++a) share *= spline((body.position[p * dim_ + a] - at_[a]) / width_);
        volume += share;
        sum += share * body.pressure[p];
      }
    return volume > 0 ? Sample{true, {sum / volume}} : Sample{};
  }

 private:
  deck::Numbers at_;
  int dim_;
  double width_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::PressureGauge& gauge, const Model& model) { return std::make_unique<Pressure>(gauge, model); }

}  // namespace jaxmpm
