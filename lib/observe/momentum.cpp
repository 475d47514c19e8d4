// Total linear momentum, Σ m v.
#include "core/parallel_host.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

class Momentum : public Gauge {
 public:
  explicit Momentum(int dim) : dim_(dim) {}
  std::vector<Channel> channels() const override {
    return {{"value", dim_ == 2 ? "kg m/s/m" : "kg m/s", value_shape(Rank::vector, dim_), component_names(Rank::vector, dim_)}};
  }
  bool uses_all_threads() const override { return true; }
  FieldSelection needs() const override { return selection({"velocity"}); }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    Sample sample{true, std::vector<double>(dim_, 0.0)};
    for (const BodySnapshot& body : scene.bodies)
      for (const Point& part : in_pieces("jaxmpm::momentum", body.mass.size(),
                                         [&](std::size_t begin, std::size_t end) { return carried_by(body, begin, end); }))
        for (int a = 0; a < dim_; ++a) sample.values[a] += part[a];
    return sample;
  }
  void gradient(const Scene& scene, const Sample&, const double* by_values, SnapshotGradient& into) const override {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const BodySnapshot& body = scene.bodies[b];
      const std::size_t n = body.mass.size();
      double* by_mass = gradient_of(&BodySnapshot::mass, into[b], n);
      double* by_velocity = gradient_of(&BodySnapshot::velocity, into[b], n * dim_);
      for (std::size_t p = 0; p < n; ++p)
        for (int a = 0; a < dim_; ++a) {
          by_mass[p] += by_values[a] * body.velocity[p * dim_ + a];
          by_velocity[p * dim_ + a] += by_values[a] * body.mass[p];
        }
    }
  }

 private:
  Point carried_by(const BodySnapshot& body, std::size_t begin, std::size_t end) const {
    Point sum{};
    for (std::size_t p = begin; p < end; ++p)
      for (int a = 0; a < dim_; ++a) sum[a] += body.mass[p] * body.velocity[p * dim_ + a];
    return sum;
  }

  int dim_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::MomentumGauge&, const Model& model) { return std::make_unique<Momentum>(model.dim); }

}  // namespace jaxmpm
