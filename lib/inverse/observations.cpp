#include "inverse/observations.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/error.hpp"
#include "inverse/observation.hpp"
#include "inverse/observed_gauge.hpp"
#include "inverse/observed_particles.hpp"
#include "observe/gauges.hpp"
#include "scene/frame.hpp"

namespace jaxmpm {
namespace {

/// Rows of one observation that are due at one time of the observer.
struct Due {
  std::size_t observation;
  RowRange range;
  std::size_t residual;  // place of the first one
};

class Observations : public Observer {
 public:
  Observations(std::vector<std::unique_ptr<Observation>> observations, const Model& model, double end)
      : observations_(std::move(observations)), bodies_(model.bodies.size()) {
    std::size_t residuals = 0;
    for (const auto& observation : observations_) {
      for (const ObservedRow& row : observation->rows()) times_.push_back(row.time);
      first_residual_.push_back(residuals);
      residuals += observation->rows().size() * observation->width();
    }
    residuals_.resize(residuals);
    merge_times(same_time * end);
    for (std::size_t o = 0; o < observations_.size(); ++o) schedule(o);
  }
  const std::vector<double>& times() const override { return times_; }
  FieldSelection needs() const override {
    FieldSelection fields;
    for (const auto& observation : observations_) fields = fields | observation->needs();
    return fields;
  }
  void look(std::size_t index, const Moment& now, const std::vector<BodySnapshot>& bodies) override {
    for (const Due& due : due_[index]) observations_[due.observation]->look(due.range, now, bodies, &residuals_[due.residual]);
    if (index + 1 < times_.size()) return;
    loss_ = 0;
    for (const double residual : residuals_) loss_ += 0.5 * residual * residual;
    warn_of_unread();
  }
  double loss() const override { return loss_; }
  const std::vector<double>& residuals() const override { return residuals_; }
  SnapshotGradient gradient(std::size_t index) const override {
    SnapshotGradient gradient(bodies_);
    for (const Due& due : due_[index]) observations_[due.observation]->add_gradient(due.range, &residuals_[due.residual], gradient);
    return gradient;
  }

 private:
  /// Times nearer than this part of the run's length are one: an automatic step is not cut into slivers.
  static constexpr double same_time = 1e-9;

  void merge_times(double tolerance) {
    std::sort(times_.begin(), times_.end());
    std::size_t kept = 0;
    for (const double time : times_)
      if (kept == 0 || time > times_[kept - 1] + tolerance) times_[kept++] = time;
    times_.resize(kept);
    due_.resize(kept);
  }
  std::size_t index_of(double time) const {
    return static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin()) - 1;
  }
  void schedule(std::size_t o) {
    const std::vector<ObservedRow>& rows = observations_[o]->rows();
    for (std::size_t r = 0; r < rows.size(); ++r) {
      std::vector<Due>& due = due_[index_of(rows[r].time)];
      if (due.empty() || due.back().observation != o) due.push_back({o, {r, r}, first_residual_[o] + r * observations_[o]->width()});
      due.back().range.last = r + 1;
    }
  }
  /// Once: later runs of an inversion would repeat it at each iteration.
  void warn_of_unread() {
    for (std::size_t o = 0; o < observations_.size() && !warned_; ++o)
      if (const std::size_t unread = observations_[o]->unread(); unread > 0)
        spdlog::warn("/inverse/observations/{}: at {} of {} rows the run has no material to read; they do not count in the loss.", o,
                     unread, observations_[o]->rows().size());
    warned_ = true;
  }

  std::vector<std::unique_ptr<Observation>> observations_;
  std::size_t bodies_;
  std::vector<double> times_;
  std::vector<std::vector<Due>> due_;        // at each time
  std::vector<std::size_t> first_residual_;  // of each observation
  std::vector<double> residuals_;
  double loss_ = 0;
  bool warned_ = false;
};

/// Makes one observation of any kind ready.
struct Prepare {
  const deck::Deck& deck;
  const ObservationPlace& place;
  std::size_t index;

  std::vector<ObservedRow> ready(std::vector<ObservedRow> rows, const deck::Observed& observed) const {
    rows = within_window(std::move(rows), observed, place);
    add_noise(rows, observed.noise, index);
    return rows;
  }
  std::unique_ptr<Observation> operator()(const deck::ParticlesObservation& observed) const {
    const std::size_t body = body_index(place.model, observed.body, place.pointer + "/body");
    return observe_particles(ready(read_particles(observed, place, body), observed), observed.weight, observed.field, body, place.model);
  }
  std::unique_ptr<Observation> operator()(const deck::GaugeObservation& observed) const {
    const auto wanted = deck.gauges.find(observed.gauge);
    if (wanted == deck.gauges.end()) throw DeckError(place.pointer + "/gauge", "there is no gauge '" + observed.gauge + "'.");
    std::vector<std::unique_ptr<Gauge>> gauges;
    gauges.push_back(std::visit([&](const auto& kind) { return make_gauge(kind, place.model); }, wanted->second));
    std::vector<ObservedRow> rows = ready(read_gauge(observed, place, *gauges[0]), observed);
    return observe_gauges(std::move(rows), observed.weight, std::move(gauges), place.model);
  }
  std::unique_ptr<Observation> operator()(const deck::ProfileObservation& observed) const {
    const std::size_t body = body_index(place.model, observed.body, place.pointer + "/body");
    ObservedProfile profile = read_profile(observed, place, body);
    std::vector<std::unique_ptr<Gauge>> gauges;
    for (const deck::Numbers& at : profile.at) gauges.push_back(make_deposit_gauge(at, place.model, body));
    return observe_gauges(ready(std::move(profile.rows), observed), observed.weight, std::move(gauges), place.model);
  }
};

}  // namespace

std::unique_ptr<Observer> make_observer(const deck::Deck& deck, const Model& model) {
  const deck::Inverse inverse = deck::inverse_of(deck);
  const Frame frame = make_frame(deck);
  const double end = TimeControl(model.time).end();
  std::vector<std::unique_ptr<Observation>> observations;
  for (std::size_t i = 0; i < inverse.observations.size(); ++i) {
    const std::string file = std::visit([](const auto& observed) { return observed.file; }, inverse.observations[i]);
    const ObservationPlace place{"/inverse/observations/" + std::to_string(i), frame.file(file), model, end};
    observations.push_back(std::visit(Prepare{deck, place, i}, inverse.observations[i]));
  }
  return std::make_unique<Observations>(std::move(observations), model, end);
}

}  // namespace jaxmpm
