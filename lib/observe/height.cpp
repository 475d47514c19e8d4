// Free surface above a point: the coordinate, along the axis that is up, at which the volume fraction
//   f(u) = Σ V φ(horizontal) φ(u − u_p) / Δh^dim
// first falls below one half on the way up from the ground. The ground is the domain's lowest face or, where an obstacle stands on it, its
// top there; mirror images behind walls and ground fill up the splines that reach beyond them.
#include <algorithm>

#include "observe/gauges.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

struct ColumnParticle {
  double height, amount;
};  // along "up", m; V φ(horizontal) / Δh^(dim−1), m

class Height : public Gauge {
 public:
  Height(const deck::HeightGauge& gauge, const Model& model)
      : dim_(model.dim), up_(up_axis(model)), width_(model.cell_size), low_(model.domain_min), high_(domain_max(model)) {
    for (int a = 0, k = 0; a < dim_; ++a) at_[a] = a == up_.axis ? 0 : gauge.at[k++];
    const double ends[2] = {up_.sign * low_[up_.axis], up_.sign * high_[up_.axis]};
    top_ = std::max(ends[0], ends[1]);
    ground_ = find_ground(model, std::min(ends[0], ends[1]));
  }
  std::vector<Channel> channels() const override { return {{"value", "m", {}, {}}}; }
  FieldSelection needs() const override { return selection({"density"}); }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    const std::vector<ColumnParticle> column = particles_above(scene);
    const double step = width_ / 8;
    const auto filled = [&](double u) { return fraction(column, u) >= 0.5; };
    double below = ground_;
    while (below <= ground_ + 1.5 * width_ && !filled(below)) below += step;
    if (!filled(below)) return {};
    while (below + step < top_ && filled(below + step)) below += step;
    return {true, {up_.sign * crossing(filled, below, below + step)}};
  }

 private:
  std::vector<ColumnParticle> particles_above(const Scene& scene) const {
    std::vector<ColumnParticle> column;
    for (const BodySnapshot& body : scene.bodies)
      for (std::size_t p = 0; p < body.id.size(); ++p) {
        double amount = body.mass[p] / body.density[p];
        for (int a = 0; a < dim_ && amount > 0; ++a)
          if (a != up_.axis) amount *= mirrored_spline(at_[a], body.position[p * dim_ + a], low_[a], high_[a], width_) / width_;
        if (amount > 0) column.push_back({up_.sign * body.position[p * dim_ + up_.axis], amount});
      }
    return column;
  }
  double fraction(const std::vector<ColumnParticle>& column, double u) const {
    double sum = 0;
    for (const ColumnParticle& p : column) sum += p.amount * mirrored_spline(u, p.height, ground_, top_, width_) / width_;
    return sum;
  }
  template <class Filled>
  static double crossing(const Filled& filled, double inside, double outside) {
    for (int halving = 0; halving < 50; ++halving) (filled(0.5 * (inside + outside)) ? inside : outside) = 0.5 * (inside + outside);
    return 0.5 * (inside + outside);
  }
  double find_ground(const Model& model, double lowest) const {
    const auto solid = [&](double u) {
      Point x{};
      for (int a = 0; a < dim_; ++a) x[a] = ((a == up_.axis ? up_.sign * u : at_[a]) - low_[a]) / width_;
      return std::any_of(model.obstacles.begin(), model.obstacles.end(),
                         [&](const RigidObstacle& o) { return o.signed_distance(x).distance < 0; });
    };
    const double step = width_ / 8;
    double u = lowest;
    while (u < top_ && solid(u + 1e-9 * width_)) u += step;
    return u > lowest ? crossing(solid, u - step, u) : lowest;
  }

  int dim_;
  UpAxis up_;
  double width_, top_ = 0, ground_ = 0;  // m; heights count along "up"
  Point low_, high_, at_{};
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::HeightGauge& gauge, const Model& model) { return std::make_unique<Height>(gauge, model); }

}  // namespace jaxmpm
