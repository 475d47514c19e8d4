#include "inverse/observations.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

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
  std::size_t difference;  // place of the first one
};

class Observations : public Observer {
 public:
  Observations(std::vector<std::unique_ptr<Observation>> observations, const Model& model, double end)
      : observations_(std::move(observations)), bodies_(model.bodies.size()) {
    for (const auto& observation : observations_) {
      for (const ObservedRow& row : observation->rows()) times_.push_back(row.time);
      first_difference_.push_back(differences_.size());
      differences_.resize(differences_.size() + observation->rows().size() * observation->width());
      first_residual_.push_back(residuals_.size());
      residuals_.resize(residuals_.size() + observation->groups() * observation->width());
    }
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
    for (const Due& due : due_[index]) observations_[due.observation]->look(due.range, now, bodies, &differences_[due.difference]);
    if (index + 1 < times_.size()) return;
    plain_ = differences_;
    std::fill(residuals_.begin(), residuals_.end(), 0.0);
    for (std::size_t o = 0; o < observations_.size(); ++o) average(o);
    loss_ = 0;
    for (const double residual : residuals_) loss_ += 0.5 * residual * residual;
    warn_of_unread();
  }
  double loss() const override { return loss_; }
  const std::vector<double>& residuals() const override { return residuals_; }
  std::vector<Comparison> comparisons() const override {
    std::vector<Comparison> all;
    for (std::size_t o = 0; o < observations_.size(); ++o) all.push_back(observations_[o]->compare(plain_.data() + first_difference_[o]));
    return all;
  }
  SnapshotGradient gradient(std::size_t index) const override {
    SnapshotGradient gradient(bodies_);
    for (const Due& due : due_[index]) observations_[due.observation]->add_gradient(due.range, &differences_[due.difference], gradient);
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
  /// A group's residual is R = Σ d/√n of its n differences that could be read: √n times their mean, so that the loss keeps its size and
  /// noise of deviation 1 in the rows gives R the deviation 1. The differences become ∂(R²/2)/∂d = R/√n.
  void average(std::size_t o) {
    const Observation& observation = *observations_[o];
    const std::size_t width = observation.width();
    double *difference = differences_.data() + first_difference_[o], *residual = residuals_.data() + first_residual_[o];
    std::vector<double> count(observation.groups(), 0.0);
    for (std::size_t r = 0; r < observation.rows().size(); ++r) count[observation.rows()[r].group] += observation.was_read(r);
    for (std::size_t r = 0; r < observation.rows().size(); ++r) {
      const std::size_t group = observation.rows()[r].group;
      for (std::size_t k = 0; k < width && count[group] > 0; ++k)
        residual[group * width + k] += difference[r * width + k] / std::sqrt(count[group]);
    }
    for (std::size_t r = 0; r < observation.rows().size(); ++r) {
      const std::size_t group = observation.rows()[r].group;
      for (std::size_t k = 0; k < width && count[group] > 0; ++k)
        difference[r * width + k] = residual[group * width + k] / std::sqrt(count[group]);
    }
  }
  void schedule(std::size_t o) {
    const std::vector<ObservedRow>& rows = observations_[o]->rows();
    for (std::size_t r = 0; r < rows.size(); ++r) {
      std::vector<Due>& due = due_[index_of(rows[r].time)];
      if (due.empty() || due.back().observation != o) due.push_back({o, {r, r}, first_difference_[o] + r * observations_[o]->width()});
      due.back().range.last = r + 1;
    }
  }
  /// Once: later runs of an inversion would repeat it at each iteration.
  void warn_of_unread() {
    for (std::size_t o = 0; o < observations_.size() && !warned_; ++o) {
      const std::size_t rows = observations_[o]->rows().size();
      std::size_t unread = 0;
      for (std::size_t r = 0; r < rows; ++r) unread += !observations_[o]->was_read(r);
      if (unread > 0)
        spdlog::warn("/inverse/observations/{}: at {} of {} rows the run has no material to read; they do not count in the loss.", o,
                     unread, rows);
    }
    warned_ = true;
  }

  std::vector<std::unique_ptr<Observation>> observations_;
  std::size_t bodies_;
  std::vector<double> times_;
  std::vector<std::vector<Due>> due_;                           // at each time
  std::vector<std::size_t> first_difference_, first_residual_;  // of each observation
  std::vector<double> differences_;                             // after the last look, the loss's derivatives by them
  std::vector<double> plain_;                                   // the differences of the last run
  std::vector<double> residuals_;
  double loss_ = 0;
  bool warned_ = false;
};

/// Makes one observation of any kind ready.
struct Prepare {
  const deck::Deck& deck;
  const ObservationPlace& place;
  std::size_t index;

  ObservedData ready(std::vector<ObservedRow> rows, const deck::Observed& observed) const {
    rows = within_window(std::move(rows), observed, place);
    add_noise(rows, observed.noise, index);
    return grouped(std::move(rows), observed.average);
  }
  std::unique_ptr<Observation> operator()(const deck::ParticlesObservation& observed) const {
    const std::size_t body = body_index(place.model, observed.body, place.pointer + "/body");
    return observe_particles(ready(read_particles(observed, place, body), observed), observed.weight, observed.field, body, place.model);
  }
  std::unique_ptr<Observation> operator()(const deck::GaugeObservation& observed) const {
    const auto wanted = deck.gauges.find(observed.gauge);
    if (wanted == deck.gauges.end()) throw DeckError(place.pointer + "/gauge", "there is no gauge '" + observed.gauge + "'.");
    std::vector<std::unique_ptr<Gauge>> gauges;
    gauges.push_back(make_gauge(wanted->first, wanted->second, place.model));
    ObservedData data = ready(read_gauge(observed, place, *gauges[0]), observed);
    return observe_gauges(std::move(data), observed.weight, std::move(gauges), place.model);
  }
  std::unique_ptr<Observation> operator()(const deck::ProfileObservation& observed) const {
    const std::size_t body = body_index(place.model, observed.body, place.pointer + "/body");
    ObservedProfile profile = read_profile(observed, place, body);
    std::vector<std::unique_ptr<Gauge>> gauges;
    for (const deck::Numbers& at : profile.at) gauges.push_back(make_deposit_gauge(at, place.model, body, observed.reading));
    return observe_gauges(ready(std::move(profile.rows), observed), observed.weight, std::move(gauges), place.model, std::move(profile.at));
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
    const ObservationPlace place{"/inverse/observations/" + std::to_string(i), frame.file(file), model, deck, end};
    observations.push_back(std::visit(Prepare{deck, place, i}, inverse.observations[i]));
  }
  return std::make_unique<Observations>(std::move(observations), model, end);
}

}  // namespace jaxmpm
