#include "observe/gauge.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "core/error.hpp"
#include "core/parallel_host.hpp"
#include "observe/gauges.hpp"

namespace jaxmpm {

std::size_t Channel::size() const {
  std::size_t count = 1;
  for (const std::size_t extent : shape) count *= extent;
  return count;
}

std::size_t GaugeSeries::width() const {
  std::size_t sum = 0;
  for (const Channel& channel : channels) sum += channel.size();
  return sum;
}

void Gauge::gradient(const Scene&, const Sample&, const double*, SnapshotGradient&) const {
  throw Error(ExitCode::deck, "a gauge of this kind has no derivative by the particles; observe another.");
}

GaugeSet::GaugeSet(const deck::Deck& deck, const Model& model) {
  for (const auto& [name, wanted] : deck.gauges) {
    std::unique_ptr<Gauge> gauge = make_gauge(name, wanted, model);
    const std::optional<Region> region = gauge->region();
    if (region) regions_.push_back(*region);
    if (Look& look = region ? nearby_ : anywhere_; gauge->needs_particles()) look = {true, look.fields | gauge->needs()};
    series_[name].channels = gauge->channels();
    gauges_[name] = std::move(gauge);
  }
}

std::unique_ptr<Gauge> make_gauge(const std::string& name, const deck::Gauge& gauge, const Model& model) {
  try {
    return std::visit([&](const auto& kind) { return make_gauge(kind, model); }, gauge);
  } catch (const DeckError& error) {  // the kinds know their own keys, not the gauge's name
    std::vector<Problem> problems = error.problems;
    for (Problem& problem : problems) problem.pointer = "/gauges/" + name + problem.pointer;
    throw DeckError(problems);
  }
}

bool GaugeSet::needs_forces() const {
  for (const auto& [name, gauge] : gauges_)
    if (gauge->needs_forces()) return true;
  return false;
}

void GaugeSet::measure(const Moment& now, const Solver& solver) {
  if (gauges_.empty()) return;
  if (anywhere_.wanted) solver.take_snapshot(anywhere_.fields, false, all_);
  const std::vector<BodySnapshot> near = nearby_.wanted ? solver.snapshot_within(regions_, nearby_.fields) : std::vector<BodySnapshot>{};
  const ContactForces forces = needs_forces() ? solver.forces() : ContactForces{};
  const Dissipation dissipation = solver.dissipation();
  const Scene everywhere{now, all_, forces, dissipation}, nearby{now, near, forces, dissipation};
  std::vector<const std::string*> names;
  for (const auto& entry : gauges_) names.push_back(&entry.first);
  std::vector<Sample> samples(names.size());
  const auto take = [&](std::size_t k) { samples[k] = read(*names[k], gauges_.at(*names[k])->region() ? nearby : everywhere); };
  std::vector<std::size_t> side_by_side;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (gauges_.at(*names[k])->uses_all_threads()) take(k);
    else side_by_side.push_back(k);
  parallel_for_host("jaxmpm::gauges", side_by_side.size(), [&](std::size_t k) { take(side_by_side[k]); });
  for (std::size_t k = 0; k < names.size(); ++k)
    for (const double value : samples[k].values)
      if (!std::isfinite(value))
        throw NumericsError(
            fmt::format("gauge '{}' is not finite at step {}, {:.9g} s: the run is unstable. Take a smaller /time/step or /time/cfl.",
                        *names[k], now.step, now.time));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Sample& sample = samples[k];
    GaugeSeries& series = series_[*names[k]];
    series.step.push_back(now.step);
    series.time.push_back(now.time);
    series.valid.push_back(sample.valid ? 1 : 0);
    series.values.insert(series.values.end(), sample.values.begin(), sample.values.end());
  }
}

Sample GaugeSet::read(const std::string& name, const Scene& scene) const {
  const GaugeSeries& past = series_.at(name);
  const std::size_t width = past.width();
  const std::vector<double> first(past.values.begin(), past.values.begin() + static_cast<std::ptrdiff_t>(past.time.empty() ? 0 : width));
  Sample sample = gauges_.at(name)->measure(scene, past.time.empty() ? nullptr : &first);
  if (!sample.valid) sample.values.assign(width, 0.0);
  return sample;
}

void GaugeSet::restore(const std::map<std::string, GaugeSeries>& series) {
  for (auto& [name, own] : series_) {
    const auto found = series.find(name);
    if (found == series.end() || found->second.width() != own.width() ||
        found->second.values.size() != own.width() * found->second.time.size())
      throw IoError("the checkpoint holds no matching readings of gauge '" + name + "'. Start the run anew with --overwrite.");
    const std::vector<Channel> channels = own.channels;
    own = found->second;
    own.channels = channels;
  }
}

void GaugeSet::drop_after(std::uint64_t step) {
  for (auto& [name, series] : series_)
    while (!series.step.empty() && series.step.back() > step) {
      series.step.pop_back();
      series.time.pop_back();
      series.valid.pop_back();
      series.values.resize(series.values.size() - series.width());
    }
}

Region around(const deck::Numbers& min, const deck::Numbers& max, double margin) {
  Region region;
  for (std::size_t a = 0; a < min.size(); ++a) region.min[a] = min[a] - margin, region.max[a] = max[a] + margin;
  return region;
}

Point domain_max(const Model& model) {
  Point top = model.domain_min;
  for (int a = 0; a < model.dim; ++a) top[a] += model.cells[a] * model.cell_size;
  return top;
}

UpAxis up_axis(const Model& model) {
  const std::size_t axis = deck::up_axis(deck::Numbers(model.gravity.begin(), model.gravity.begin() + model.dim));
  return {int(axis), model.gravity[axis] > 0 ? -1.0 : 1.0};
}

std::size_t body_index(const Model& model, const std::string& name, const std::string& pointer) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (model.bodies[b].name == name) return b;
  throw DeckError(pointer, "there is no body '" + name + "'.");
}

}  // namespace jaxmpm
