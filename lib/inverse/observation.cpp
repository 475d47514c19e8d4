#include "inverse/observation.hpp"

#include <cmath>

namespace jaxmpm {
namespace {

class ObservedParticles : public Observation {
 public:
  ObservedParticles(ObservedData data, double weight, const std::string& field, std::size_t body, const Model& model)
      : Observation(std::move(data), weight), field_(output_field(field)), body_(body), particles_(model.bodies[body].initial.id.size()) {
    for (std::size_t d = 0; d < std::size_t(model.dim); ++d)
      period_[d] = field == "position" && model.is_periodic(int(d)) ? model.cells[d] * model.cell_size : 0;
  }
  FieldSelection needs() const override { return selection({field_.name}); }
  void look(const RowRange& range, const Moment&, const std::vector<BodySnapshot>& bodies, double* differences) override {
    const std::vector<double>& values = bodies[body_].*field_.values;
    for (std::size_t r = range.first; r < range.last; ++r)
      for (std::size_t k = 0; k < width(); ++k)
        *differences++ = scale(rows()[r]) * nearest(values[rows()[r].subject * width() + k] - rows()[r].value[k], k);
  }
  void add_gradient(const RowRange& range, const double* by_differences, SnapshotGradient& into) const override {
    for (std::size_t r = range.first; r < range.last; ++r)
      for (std::size_t k = 0; k < width(); ++k)
        add_field_gradient(field_, *by_differences++ * scale(rows()[r]), rows()[r].subject, k, width(), particles_, into[body_]);
  }

 private:
  /// Across periodic faces the nearest image counts.
  double nearest(double difference, std::size_t axis) const {
    return period_[axis] > 0 ? std::remainder(difference, period_[axis]) : difference;
  }
  const OutputField& field_;
  std::size_t body_, particles_;
  std::array<double, 3> period_{};  // m, of positions
};

/// Derivatives by one field of one body, without the zeros: most gauges look at a small part of the material.
struct SparseField {
  std::size_t body;
  std::vector<double> BodySnapshot::*field;
  std::size_t size;
  std::vector<std::size_t> at;
  std::vector<double> value;
};

std::vector<SparseField> sparse(const SnapshotGradient& gradient) {
  using B = BodySnapshot;
  std::vector<SparseField> fields;
  for (std::size_t b = 0; b < gradient.size(); ++b)
    for (const auto field : {&B::position, &B::velocity, &B::mass, &B::density, &B::stress, &B::plastic_strain}) {
      const std::vector<double>& dense = gradient[b].*field;
      SparseField kept{b, field, dense.size(), {}, {}};
      for (std::size_t i = 0; i < dense.size(); ++i)
        if (dense[i] != 0) {
          kept.at.push_back(i);
          kept.value.push_back(dense[i]);
        }
      if (!kept.at.empty()) fields.push_back(std::move(kept));
    }
  return fields;
}

/// Gauges are differentiated while they look, number by number: the state is not there afterwards, when it is known how much each counts.
class ObservedGauges : public Observation {
 public:
  ObservedGauges(ObservedData data, double weight, std::vector<std::unique_ptr<Gauge>> gauges, const Model& model,
                 std::vector<deck::Numbers> places)
      : Observation(std::move(data), weight),
        gauges_(std::move(gauges)),
        places_(std::move(places)),
        bodies_(model.bodies.size()),
        read_(rows().size(), true) {
    derivatives_.resize(rows().size() * width());
  }
  FieldSelection needs() const override {
    FieldSelection fields;
    for (const auto& gauge : gauges_) fields = fields | gauge->needs();
    return fields;
  }
  void look(const RowRange& range, const Moment& now, const std::vector<BodySnapshot>& bodies, double* differences) override {
    const ContactForces forces;
    const Scene scene{now, bodies, forces, {}};
    for (std::size_t r = range.first; r < range.last; ++r) {
      const Sample reading = gauges_[rows()[r].subject]->measure(scene, nullptr);
      read_[r] = reading.valid;
      for (std::size_t k = 0; k < width(); ++k) {
        *differences++ = reading.valid ? scale(rows()[r]) * (reading.values[k] - rows()[r].value[k]) : 0;
        derivatives_[r * width() + k] = derivative(r, k, scene, reading);
      }
    }
  }
  void add_gradient(const RowRange& range, const double* by_differences, SnapshotGradient& into) const override {
    for (std::size_t d = range.first * width(); d < range.last * width(); ++d, ++by_differences)
      for (const SparseField& part : derivatives_[d]) {
        double* values = gradient_of(part.field, into[part.body], part.size);
        for (std::size_t i = 0; i < part.at.size(); ++i) values[part.at[i]] += *by_differences * part.value[i];
      }
  }
  bool was_read(std::size_t row) const override { return read_[row]; }
  std::vector<std::vector<double>> places() const override { return places_; }

 private:
  /// Of difference k of a row by the state.
  std::vector<SparseField> derivative(std::size_t row, std::size_t k, const Scene& scene, const Sample& reading) const {
    if (!reading.valid) return {};
    std::vector<double> by_values(width(), 0.0);
    by_values[k] = scale(rows()[row]);
    SnapshotGradient gradient(bodies_);
    gauges_[rows()[row].subject]->gradient(scene, reading, by_values.data(), gradient);
    return sparse(gradient);
  }

  std::vector<std::unique_ptr<Gauge>> gauges_;
  std::vector<deck::Numbers> places_;
  std::size_t bodies_;
  std::vector<bool> read_;                             // of each row
  std::vector<std::vector<SparseField>> derivatives_;  // of each number of each row
};

}  // namespace

Observation::Observation(ObservedData data, double weight)
    : rows_(std::move(data.rows)), root_weight_(std::sqrt(weight)), width_(rows_.at(0).value.size()), groups_(data.groups) {}

double Observation::scale(const ObservedRow& row) const { return root_weight_ / row.sigma; }

Comparison Observation::compare(const double* differences) const {
  Comparison found;
  found.width = width_;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const ObservedRow& row = rows_[r];
    found.time.push_back(row.time), found.subject.push_back(row.subject), found.sigma.push_back(row.sigma);
    for (std::size_t k = 0; k < width_; ++k) {
      found.observed.push_back(row.value[k]);
      found.read.push_back(was_read(r) ? row.value[k] + differences[r * width_ + k] / scale(row) : std::nan(""));
    }
  }
  found.places = places();
  return found;
}

std::unique_ptr<Observation> observe_particles(ObservedData data, double weight, const std::string& field, std::size_t body,
                                               const Model& model) {
  return std::make_unique<ObservedParticles>(std::move(data), weight, field, body, model);
}

std::unique_ptr<Observation> observe_gauges(ObservedData data, double weight, std::vector<std::unique_ptr<Gauge>> gauges,
                                            const Model& model, std::vector<deck::Numbers> places) {
  return std::make_unique<ObservedGauges>(std::move(data), weight, std::move(gauges), model, std::move(places));
}

}  // namespace jaxmpm
