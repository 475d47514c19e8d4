#include "inverse/observation.hpp"

#include <algorithm>
#include <cmath>

namespace jaxmpm {
namespace {

class ObservedParticles : public Observation {
 public:
  ObservedParticles(std::vector<ObservedRow> rows, double weight, const std::string& field, std::size_t body, const Model& model)
      : Observation(std::move(rows), weight), field_(output_field(field)), body_(body), particles_(model.bodies[body].initial.id.size()) {}
  FieldSelection needs() const override { return selection({field_.name}); }
  void look(const RowRange& range, const Moment&, const std::vector<BodySnapshot>& bodies, double* residuals) override {
    const std::vector<double>& values = bodies[body_].*field_.values;
    for (std::size_t r = range.first; r < range.last; ++r)
      for (std::size_t k = 0; k < width(); ++k)
        *residuals++ = scale(rows()[r]) * (values[rows()[r].subject * width() + k] - rows()[r].value[k]);
  }
  void add_gradient(const RowRange& range, const double* residuals, SnapshotGradient& into) const override {
    for (std::size_t r = range.first; r < range.last; ++r)
      for (std::size_t k = 0; k < width(); ++k)
        add_field_gradient(field_, *residuals++ * scale(rows()[r]), rows()[r].subject, k, width(), particles_, into[body_]);
  }

 private:
  const OutputField& field_;
  std::size_t body_, particles_;
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

/// Gauges are differentiated while they look: the state is not there afterwards.
class ObservedGauges : public Observation {
 public:
  ObservedGauges(std::vector<ObservedRow> rows, double weight, std::vector<std::unique_ptr<Gauge>> gauges, const Model& model)
      : Observation(std::move(rows), weight), gauges_(std::move(gauges)), bodies_(model.bodies.size()), read_(this->rows().size(), true) {
    gradients_.resize(this->rows().size());
  }
  FieldSelection needs() const override {
    FieldSelection fields;
    for (const auto& gauge : gauges_) fields = fields | gauge->needs();
    return fields;
  }
  void look(const RowRange& range, const Moment& now, const std::vector<BodySnapshot>& bodies, double* residuals) override {
    const ContactForces forces;
    const Scene scene{now, bodies, forces, {}};
    SnapshotGradient gradient(bodies_);
    for (std::size_t r = range.first; r < range.last; ++r, residuals += width()) {
      const ObservedRow& row = rows()[r];
      const Gauge& gauge = *gauges_[row.subject];
      const Sample reading = gauge.measure(scene, nullptr);
      read_[r] = reading.valid;
      std::vector<double> by_values(width(), 0.0);
      for (std::size_t k = 0; k < width(); ++k) {
        residuals[k] = reading.valid ? scale(row) * (reading.values[k] - row.value[k]) : 0;
        by_values[k] = scale(row) * residuals[k];
      }
      if (reading.valid) gauge.gradient(scene, reading, by_values.data(), gradient);
    }
    gradients_[range.first] = sparse(gradient);
  }
  void add_gradient(const RowRange& range, const double*, SnapshotGradient& into) const override {
    for (const SparseField& part : gradients_[range.first]) {
      double* values = gradient_of(part.field, into[part.body], part.size);
      for (std::size_t i = 0; i < part.at.size(); ++i) values[part.at[i]] += part.value[i];
    }
  }
  std::size_t unread() const override { return static_cast<std::size_t>(std::count(read_.begin(), read_.end(), false)); }

 private:
  std::vector<std::unique_ptr<Gauge>> gauges_;
  std::size_t bodies_;
  std::vector<bool> read_;                           // of each row
  std::vector<std::vector<SparseField>> gradients_;  // of the rows of one time, at the place of the first of them
};

}  // namespace

Observation::Observation(std::vector<ObservedRow> rows, double weight)
    : rows_(std::move(rows)), root_weight_(std::sqrt(weight)), width_(rows_.at(0).value.size()) {}

double Observation::scale(const ObservedRow& row) const { return root_weight_ / row.sigma; }

std::unique_ptr<Observation> observe_particles(std::vector<ObservedRow> rows, double weight, const std::string& field, std::size_t body,
                                               const Model& model) {
  return std::make_unique<ObservedParticles>(std::move(rows), weight, field, body, model);
}

std::unique_ptr<Observation> observe_gauges(std::vector<ObservedRow> rows, double weight, std::vector<std::unique_ptr<Gauge>> gauges,
                                            const Model& model) {
  return std::make_unique<ObservedGauges>(std::move(rows), weight, std::move(gauges), model);
}

}  // namespace jaxmpm
