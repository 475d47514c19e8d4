// Free surface above a point: the coordinate, along the axis that is up, at which the volume fraction
//   f(u) = Σ V φ(horizontal) φ(u − u_p) / Δh^dim
// first falls below one half on the way up from the ground. The ground is the domain's lowest face or, where an obstacle stands on it, its
// top there; mirror images behind walls and ground fill up the splines that reach beyond them.
#include <algorithm>

#include "observe/gauges.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

/// The one body that counts, and how it is read.
struct Deposit {
  std::size_t body;
  deck::ProfileReading reading;
};

struct ColumnParticle {
  double height, amount;  // along "up", m; V φ(horizontal) / Δh^(dim−1), m
  std::size_t body, particle;
};

class Height : public Gauge {
 public:
  /// `deposit`: the ground is the reading where it is not; without one all bodies count, and the reading is masked there.
  Height(const deck::Numbers& at, const Model& model, std::optional<Deposit> deposit)
      : dim_(model.dim), deposit_(deposit), up_(up_axis(model)), width_(model.cell_size), low_(model.domain_min), high_(domain_max(model)) {
    for (int a = 0, k = 0; a < dim_; ++a) at_[a] = a == up_.axis ? 0 : at[k++];
    const double ends[2] = {up_.sign * low_[up_.axis], up_.sign * high_[up_.axis]};
    top_ = std::max(ends[0], ends[1]);
    ground_ = find_ground(model, std::min(ends[0], ends[1]));
  }
  std::vector<Channel> channels() const override { return {{"value", "m", {}, {}}}; }
  FieldSelection needs() const override { return selection({"density"}); }
  std::optional<Region> region() const override {
    Region column{low_, high_};
    for (int a = 0; a < dim_; ++a)
      if (a != up_.axis) column.min[a] = at_[a] - reach * width_, column.max[a] = at_[a] + reach * width_;
    return column;
  }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    const std::vector<ColumnParticle> column = particles_above(scene);
    if (reads_depth()) return {true, {up_.sign * (ground_ + depth(column))}};
    const double step = width_ / 8;
    const auto filled = [&](double u) { return fraction(column, u) >= 0.5; };
    double below = ground_;
    while (below <= ground_ + 1.5 * width_ && !filled(below)) below += step;
    if (!filled(below)) return deposit_ ? Sample{true, {up_.sign * ground_}} : Sample{};
    while (below + step < top_ && filled(below + step)) below += step;
    return {true, {up_.sign * crossing(filled, below, below + step)}};
  }
  /// du = −Σ df / f'(u). Zero where the column is empty, or full to the top: no particle moves the surface then.
  void gradient(const Scene& scene, const Sample& reading, const double* by_values, SnapshotGradient& into) const override {
    const double u = up_.sign * reading.values[0];
    const std::vector<ColumnParticle> column = particles_above(scene);
    if (reads_depth()) {
      for (const ColumnParticle& p : column) add_gradient(scene.bodies[p.body], p, 0, up_.sign * by_values[0], into[p.body]);
      return;
    }
    if (std::abs(fraction(column, u) - 0.5) > 1e-6) return;
    double slope = 0;
    for (const ColumnParticle& p : column) slope += p.amount * mirrored_spline_slope(u, p.height, ground_, top_, width_).by_x / width_;
    if (slope >= 0) return;
    for (const ColumnParticle& p : column) {
      const double by_fraction = -up_.sign * by_values[0] / slope;
      const double by_height = by_fraction * p.amount * mirrored_spline_slope(u, p.height, ground_, top_, width_).by_xp / width_;
      const double by_amount = by_fraction * mirrored_spline(u, p.height, ground_, top_, width_) / width_;
      add_gradient(scene.bodies[p.body], p, up_.sign * by_height, by_amount, into[p.body]);
    }
  }

 private:
  bool counts(std::size_t body) const { return !deposit_ || deposit_->body == body; }
  bool reads_depth() const { return deposit_ && deposit_->reading == deck::ProfileReading::depth; }
  /// ∫ f du: volume of all material by area, m.
  static double depth(const std::vector<ColumnParticle>& column) {
    double sum = 0;
    for (const ColumnParticle& p : column) sum += p.amount;
    return sum;
  }
  double across(int a, double x) const { return mirrored_spline(at_[a], x, low_[a], high_[a], width_) / width_; }
  /// Adds the derivatives of a particle, given those by its coordinate along the up axis and by its amount.
  void add_gradient(const BodySnapshot& body, const ColumnParticle& p, double by_up, double by_amount, BodySnapshot& into) const {
    const std::size_t n = body.id.size(), i = p.particle;
    double* by_position = gradient_of(&BodySnapshot::position, into, n * dim_) + i * dim_;
    for (int a = 0; a < dim_; ++a) {
      const double x = body.position[i * dim_ + a];
      by_position[a] +=
          a == up_.axis ? by_up
                        : by_amount * p.amount * mirrored_spline_slope(at_[a], x, low_[a], high_[a], width_).by_xp / width_ / across(a, x);
    }
    gradient_of(&BodySnapshot::mass, into, n)[i] += by_amount * p.amount / body.mass[i];
    gradient_of(&BodySnapshot::density, into, n)[i] -= by_amount * p.amount / body.density[i];
  }
  /// In order of heights.
  std::vector<ColumnParticle> particles_above(const Scene& scene) const {
    std::vector<ColumnParticle> column;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      for (std::size_t p = 0; counts(b) && p < scene.bodies[b].id.size(); ++p) {
        const BodySnapshot& body = scene.bodies[b];
        double amount = 1;
        for (int a = 0; a < dim_ && amount > 0; ++a)
          if (a != up_.axis) amount *= across(a, body.position[p * dim_ + a]);
        if (amount > 0) amount *= body.mass[p] / body.density[p];
        if (amount > 0) column.push_back({up_.sign * body.position[p * dim_ + up_.axis], amount, b, p});
      }
    std::sort(column.begin(), column.end(), [](const ColumnParticle& a, const ColumnParticle& b) { return a.height < b.height; });
    return column;
  }
  /// `column` is in order of heights. What mirror images give at u, the material itself gives at the mirror images of u.
  double fraction(const std::vector<ColumnParticle>& column, double u) const {
    return sum_around(column, u) + sum_around(column, 2 * ground_ - u) + sum_around(column, 2 * top_ - u);
  }
  double sum_around(const std::vector<ColumnParticle>& column, double u) const {
    const auto below = [](const ColumnParticle& p, double height) { return p.height < height; };
    double sum = 0;
    for (auto p = std::lower_bound(column.begin(), column.end(), u - reach * width_, below); p != column.end(); ++p) {
      if (p->height > u + reach * width_) break;
      sum += p->amount * spline((u - p->height) / width_) / width_;
    }
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
  std::optional<Deposit> deposit_;
  UpAxis up_;
  double width_, top_ = 0, ground_ = 0;  // m; heights count along "up"
  Point low_, high_, at_{};
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::HeightGauge& gauge, const Model& model) {
  return std::make_unique<Height>(gauge.at, model, std::nullopt);
}

std::unique_ptr<Gauge> make_deposit_gauge(const deck::Numbers& at, const Model& model, std::size_t body, deck::ProfileReading reading) {
  return std::make_unique<Height>(at, model, Deposit{body, reading});
}

}  // namespace jaxmpm
