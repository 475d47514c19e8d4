// Fields of chosen particles, one dataset for each field, in the order in which the deck lists the ids.
#include <unordered_map>

#include "core/error.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

class Particles : public Gauge {
 public:
  Particles(const deck::ParticlesGauge& gauge, const Model& model) : dim_(model.dim), fields_(gauge.fields) {
    for (const std::int64_t id : gauge.ids) place_.emplace(id, place_.size());
    check(gauge, model);
  }
  std::vector<Channel> channels() const override {
    std::vector<Channel> all;
    for (const std::string& name : fields_) {
      const OutputField& field = output_field(name);
      std::vector<std::size_t> shape = value_shape(field.rank, dim_);
      shape.insert(shape.begin(), place_.size());
      all.push_back({name, field.unit, shape, component_names(field.rank, dim_)});
    }
    return all;
  }
  FieldSelection needs() const override { return selection(fields_); }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    Sample sample{true, {}};
    for (const std::string& name : fields_) {
      const OutputField& field = output_field(name);
      const std::size_t size = component_count(field.rank, dim_), begin = sample.values.size();
      sample.values.resize(begin + size * place_.size());
      for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        for (std::size_t p = 0; p < scene.bodies[b].id.size(); ++p)
          if (const auto found = place_.find(scene.bodies[b].id[p]); found != place_.end())
            for (std::size_t k = 0; k < size; ++k)
              sample.values[begin + found->second * size + k] = field_value(field, scene.bodies[b], b, p, k, size);
    }
    return sample;
  }
  void gradient(const Scene& scene, const Sample&, const double* by_values, SnapshotGradient& into) const override {
    for (const std::string& name : fields_) {
      const OutputField& field = output_field(name);
      if (!has_derivative(field)) Gauge::gradient(scene, {}, by_values, into);
      const std::size_t size = component_count(field.rank, dim_);
      for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        for (std::size_t p = 0, n = scene.bodies[b].id.size(); p < n; ++p)
          if (const auto found = place_.find(scene.bodies[b].id[p]); found != place_.end())
            for (std::size_t k = 0; k < size; ++k) add_field_gradient(field, by_values[found->second * size + k], p, k, size, n, into[b]);
      by_values += size * place_.size();
    }
  }

 private:
  void check(const deck::ParticlesGauge& gauge, const Model& model) const {
    std::unordered_map<std::int64_t, bool> seen;
    for (const Body& body : model.bodies)
      for (const std::uint32_t id : body.initial.id)
        if (place_.count(id)) seen[id] = true;
    for (std::size_t i = 0; i < gauge.ids.size(); ++i)
      if (!seen.count(gauge.ids[i]))
        throw DeckError("/ids/" + std::to_string(i),
                        "no particle has the id " + std::to_string(gauge.ids[i]) + "; `jaxmpm check` prints their number.");
  }

  int dim_;
  std::vector<std::string> fields_;
  std::unordered_map<std::int64_t, std::size_t> place_;
};

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::ParticlesGauge& gauge, const Model& model) {
  return std::make_unique<Particles>(gauge, model);
}

}  // namespace jaxmpm
