// Force that the material exerts on an obstacle or a wall during the step that ends at the reading. Before the first step there is none to
// read.
#include "core/error.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {
namespace {

class Force : public Gauge {
 public:
  Force(int dim, bool on_wall, std::size_t index) : dim_(dim), on_wall_(on_wall), index_(index) {}
  std::vector<Channel> channels() const override {
    return {{"value", dim_ == 2 ? "N/m" : "N", value_shape(Rank::vector, dim_), component_names(Rank::vector, dim_)}};
  }
  bool needs_particles() const override { return false; }
  bool needs_forces() const override { return true; }
  Sample measure(const Scene& scene, const std::vector<double>*) const override {
    if (scene.now.step == 0) return {};
    const Point& on_material = on_wall_ ? scene.forces.face[index_] : scene.forces.obstacle.at(index_);
    Sample sample{true, {}};
    for (int a = 0; a < dim_; ++a) sample.values.push_back(-on_material[a]);
    return sample;
  }

 private:
  int dim_;
  bool on_wall_;
  std::size_t index_;
};

std::size_t face_index(const std::string& name, int dim) {
  const std::vector<std::string> faces = deck::face_names(dim);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f] == name) return f;
  throw DeckError("/wall", "there is no wall '" + name + "' in this domain.");
}

}  // namespace

std::unique_ptr<Gauge> make_gauge(const deck::ForceGauge& gauge, const Model& model) {
  if (!gauge.wall.empty()) return std::make_unique<Force>(model.dim, true, face_index(gauge.wall, model.dim));
  for (std::size_t o = 0; o < model.obstacles.size(); ++o)
    if (model.obstacles[o].name == gauge.obstacle) return std::make_unique<Force>(model.dim, false, o);
  throw DeckError("/obstacle", "there is no obstacle '" + gauge.obstacle + "'.");
}

}  // namespace jaxmpm
