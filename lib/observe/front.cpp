// How far a body reaches: along an axis, or in horizontal distance from a centre.
#include "observe/front.hpp"

#include <cmath>

#include "observe/clusters.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

class Front : public Gauge {
 public:
  Front(const deck::FrontGauge& gauge, const Model& model)
      : gauge_(gauge),
        body_(body_index(model, gauge.body, "/body")),
        up_(up_axis(model).axis),
        width_(gauge.smooth.value_or(model.cell_size)) {
    // What the gauge needs of the model, without its particles.
    model_.dim = model.dim;
    model_.cells = model.cells;
    model_.domain_min = model.domain_min;
    model_.cell_size = model.cell_size;
    high_ = domain_max(model);
    radial_ = gauge.axis == "radius";
    axis_ = radial_ ? -1 : gauge.axis[0] - 'x';
    if (radial_)
      for (int a = 0, k = 0; a < model.dim; ++a) center_[a] = a == up_ ? 0 : gauge.center[k++];
  }
  std::vector<Channel> channels() const override { return {{"value", "m", {}, {}}}; }
  bool uses_all_threads() const override { return true; }
  FieldSelection needs() const override { return gauge_.depth ? selection({"density"}) : FieldSelection{}; }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    const std::vector<bool> kept = kept_of(scene.bodies[body_]);
    const Material material = material_of(scene.bodies[body_], kept);
    const double sign = direction();
    Sample sample = gauge_.depth
                        ? depth_front(material, *gauge_.depth, width_, model_.cell_size, [&](double s) { return breadth(sign * s); })
                        : quantile_front(material, quantile(), width_, model_.cell_size);
    for (double& value : sample.values) value *= sign;
    return sample;
  }
  void gradient(const Scene& scene, const Sample& reading, const double* by_values, SnapshotGradient& into) const override {
    const BodySnapshot& body = scene.bodies[body_];
    const std::vector<bool> kept = kept_of(body);
    const Material material = material_of(body, kept);
    const double sign = direction(), s = sign * reading.values[0], by_s = sign * by_values[0];
    const std::vector<AlongGradient> along =
        gauge_.depth ? depth_front_gradient(material, s, *gauge_.depth, width_, breadth(reading.values[0]), breadth_slope(s))
                     : quantile_front_gradient(material, s, quantile(), width_);
    const std::size_t n = body.id.size();
    double* by_position = gradient_of(&BodySnapshot::position, into[body_], n * model_.dim);
    double* by_mass = gradient_of(&BodySnapshot::mass, into[body_], n);
    double* by_density = gauge_.depth ? gradient_of(&BodySnapshot::density, into[body_], n) : nullptr;
    for (std::size_t p = 0; p < n; ++p) {
      if (!kept.empty() && !kept[p]) continue;
      add_coordinate_gradient(&body.position[p * model_.dim], sign * by_s * along[p].by_s, by_position + p * model_.dim);
      const double by_amount = by_s * along[p].by_amount;
      by_mass[p] += gauge_.depth ? by_amount / body.density[p] : by_amount;
      if (gauge_.depth) by_density[p] -= by_amount * amount_of(body, p) / body.density[p];
    }
  }

 private:
  /// The body's material along the coordinate, towards the front; refers to both.
  Material material_of(const BodySnapshot& body, const std::vector<bool>& kept) const {
    const double sign = direction();
    const auto read = [this, &body, sign, &kept](std::size_t begin, std::size_t end, Along* out) {
      for (std::size_t p = begin; p < end; ++p)
        *out++ = {sign * coordinate(&body.position[p * model_.dim]), kept.empty() || kept[p] ? amount_of(body, p) : 0};
    };
    return {body.id.size(), read};
  }
  /// Which particles count; empty when all do.
  std::vector<bool> kept_of(const BodySnapshot& body) const {
    return gauge_.connected ? in_largest_cluster(body, model_) : std::vector<bool>{};
  }
  double amount_of(const BodySnapshot& body, std::size_t p) const { return gauge_.depth ? body.mass[p] / body.density[p] : body.mass[p]; }
  double direction() const { return gauge_.direction == "-" ? -1 : 1; }
  double quantile() const { return gauge_.quantile.value_or(0.995); }

  double coordinate(const double* x) const {
    if (!radial_) return x[axis_];
    double square = 0;
    for (int a = 0; a < model_.dim; ++a)
      if (a != up_) square += (x[a] - center_[a]) * (x[a] - center_[a]);
    return std::sqrt(square);
  }

  void add_coordinate_gradient(const double* x, double by_coordinate, double* into) const {
    if (!radial_) {
      into[axis_] += by_coordinate;
      return;
    }
    const double radius = coordinate(x);
    for (int a = 0; a < model_.dim && radius > 0; ++a)
      if (a != up_) into[a] += by_coordinate * (x[a] - center_[a]) / radius;
  }

  /// Horizontal extent across the coordinate: the domain's breadth (1 in 2D), or the part of the circle that lies in the domain.
  double breadth(double s) const {
    if (radial_) return arc(s);
    double extent = 1;
    for (int a = 0; a < model_.dim; ++a)
      if (a != axis_ && a != up_) extent *= high_[a] - model_.domain_min[a];
    return extent;
  }
  /// Derivative of the breadth by s: an arc grows with its radius.
  double breadth_slope(double s) const { return radial_ && model_.dim == 3 && s != 0 ? arc(s) / s : 0; }
  double arc(double radius) const {
    constexpr int pieces = 720;
    int inside = 0;
    if (model_.dim == 2) {  // the two points at that distance
      const int a = 1 - up_;
      for (const double x : {center_[a] - radius, center_[a] + radius}) inside += x >= model_.domain_min[a] && x <= high_[a];
      return inside;
    }
    for (int k = 0; k < pieces; ++k) {
      const double angle = 2 * M_PI * (k + 0.5) / pieces, offset[2] = {radius * std::cos(angle), radius * std::sin(angle)};
      bool within = true;
      for (int a = 0, h = 0; a < 3; ++a)
        if (a != up_) {
          const double x = center_[a] + offset[h++];
          within = within && x >= model_.domain_min[a] && x <= high_[a];
        }
      inside += within;
    }
    return 2 * M_PI * std::abs(radius) * inside / pieces;
  }

  deck::FrontGauge gauge_;
  Model model_;
  std::size_t body_;
  int up_, axis_ = 0;
  bool radial_ = false;
  double width_;
  Point center_{}, high_{};
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::FrontGauge& gauge, const Model& model) { return std::make_unique<Front>(gauge, model); }

}  // namespace jaxmpm
