#pragma once
// Gauges: small series in time that a deck asks for. One file per kind, one line in the registry (gauges.hpp). Sums run over particles in
// storage order, or over pieces of it and then in their order, which is the same with any number of threads. Where there is no material a
// sample is masked (valid = 0, value 0), never NaN.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "observe/fields.hpp"
#include "solvers/time_control.hpp"

namespace jaxmpm {

/// One dataset of a gauge: its name ("value" unless there are several), unit, the shape of a sample (empty for a scalar) and the names of
/// its components.
struct Channel {
  std::string name, unit;
  std::vector<std::size_t> shape;
  std::vector<std::string> components;
  std::size_t size() const;
};

/// One reading: the channels' values one after another.
struct Sample {
  bool valid = false;
  std::vector<double> values;
};

/// What a gauge looks at.
struct Scene {
  Moment now;
  const std::vector<BodySnapshot>& bodies;
  const ContactForces& forces;
  const Dissipation& dissipation;
};

class Gauge {
 public:
  virtual ~Gauge() = default;
  virtual std::vector<Channel> channels() const = 0;
  virtual FieldSelection needs() const { return {}; }
  virtual bool needs_particles() const { return true; }
  /// Where the particles that it looks at are, if not anywhere.
  virtual std::optional<Region> region() const { return std::nullopt; }
  virtual bool needs_forces() const { return false; }
  /// Whether measure() hands its particles to all threads; the others are read side by side.
  virtual bool uses_all_threads() const { return false; }
  /// `first` is the gauge's own first reading, null while there is none.
  virtual Sample measure(const Scene& scene, const std::vector<double>* first) const = 0;
  /// Adds Σ by_values · ∂values/∂(particles) to `into`, which has the scene's bodies. `reading` is the valid one that measure() gave for
  /// this scene. Which particles belong to the largest cluster, and what part of a circle lies in the domain, are held fixed. Throws Error
  /// (exit 2) where the kind of gauge has no derivative: the deck's check lets no observation of it through.
  virtual void gradient(const Scene& scene, const Sample& reading, const double* by_values, SnapshotGradient& into) const;
};

/// Readings so far. `values` holds width numbers for each time.
struct GaugeSeries {
  std::vector<Channel> channels;
  std::vector<std::uint64_t> step;
  std::vector<double> time;
  std::vector<unsigned char> valid;
  std::vector<double> values;
  std::size_t width() const;
};

/// All gauges of a deck with their series.
class GaugeSet {
 public:
  /// Throws DeckError when a gauge asks for what the model does not have.
  GaugeSet(const deck::Deck& deck, const Model& model);
  bool empty() const { return gauges_.empty(); }
  bool needs_forces() const;
  /// Takes a reading of every gauge. Throws NumericsError, and keeps nothing of it, when one is not finite.
  void measure(const Moment& now, const Solver& solver);
  const std::map<std::string, GaugeSeries>& series() const { return series_; }
  /// Takes over the readings of a checkpoint. Throws IoError when they are not of these gauges.
  void restore(const std::map<std::string, GaugeSeries>& series);
  /// Forgets readings after a step.
  void drop_after(std::uint64_t step);

 private:
  Sample read(const std::string& name, const Scene& scene) const;

  std::map<std::string, std::unique_ptr<Gauge>> gauges_;
  std::map<std::string, GaugeSeries> series_;
  /// Gauges that look at particles anywhere, and those that look at regions: what they need.
  struct Look {
    bool wanted = false;
    FieldSelection fields;
  };
  Look anywhere_, nearby_;
  std::vector<Region> regions_;
  std::vector<BodySnapshot> all_;  // what gauges that look anywhere see
};

}  // namespace jaxmpm
