#include "inverse/observed_gauge.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "inverse/observed_table.hpp"
#include "io/results_reader.hpp"

namespace jaxmpm {
namespace {

/// A gauge of the same name that reads something else would be compared without a word. `smooth` may differ: its default is the cell size.
void require_same_gauge(const deck::GaugeObservation& observed, const ObservationPlace& place, const ResultsReader& results) {
  using Json = nlohmann::json;
  const auto definition = [&](const std::string& deck) {
    Json gauge = Json::parse(deck).at("gauges").at(observed.gauge);
    gauge.erase("smooth");
    return gauge;
  };
  const Json there = definition(results.deck()), here = definition(place.deck.resolved);
  if (there == here) return;
  place.bad_file(0, "gauge '" + observed.gauge + "' is another one there, " + there.dump() + ", than in this deck, " + here.dump() +
                        "; make them the same, or take another gauge");
}

std::vector<ObservedRow> rows_of_results(const deck::GaugeObservation& observed, const ObservationPlace& place, const Gauge& gauge) {
  const ResultsReader results(place.file);
  const std::vector<std::string> known = results.gauges();
  std::string names;
  for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
  if (std::find(known.begin(), known.end(), observed.gauge) == known.end())
    place.bad_file(0, "the run has no gauge '" + observed.gauge + "'; " + (names.empty() ? "it has none" : "its gauges are " + names));
  std::vector<std::string> datasets;
  std::size_t width = 0;
  for (const Channel& channel : gauge.channels()) {
    datasets.push_back(channel.name);
    width += channel.size();
  }
  require_same_gauge(observed, place, results);
  const GaugeReadings readings = results.gauge(observed.gauge, datasets);
  if (!readings.time.empty() && readings.width != width)
    place.bad_file(0, "gauge '" + observed.gauge + "' has " + std::to_string(readings.width) + " values at each time there and " +
                          std::to_string(width) + " in this deck; make them the same kind of gauge");
  std::vector<ObservedRow> rows;
  for (std::size_t t = 0; t < readings.time.size(); ++t) {
    const auto first = readings.values.begin() + static_cast<std::ptrdiff_t>(t * width);
    if (readings.valid[t]) rows.push_back({readings.time[t], 0, {first, first + static_cast<std::ptrdiff_t>(width)}, 1, 0});
  }
  return rows;
}

/// The CSV's columns of a gauge's values.
std::vector<std::string> value_columns(const deck::GaugeObservation& observed, const ObservationPlace& place, const Gauge& gauge) {
  const std::vector<Channel> channels = gauge.channels();
  if (channels.size() != 1 || channels[0].name != "value")
    throw DeckError(place.pointer + "/gauge",
                    "\"" + observed.gauge + "\" reads fields of particles; from CSV, observe them as \"particles\"");
  if (channels[0].components.empty()) return {"value"};
  std::vector<std::string> columns;
  for (const std::string& component : channels[0].components) columns.push_back("value_" + component);
  return columns;
}

}  // namespace

std::vector<ObservedRow> read_gauge(const deck::GaugeObservation& observed, const ObservationPlace& place, const Gauge& gauge) {
  if (is_hdf5(place.file)) {
    refuse_mask_column(observed, place);
    return rows_of_results(observed, place, gauge);
  }
  const ObservedTable table(observed, place);
  const std::vector<std::string> columns = value_columns(observed, place, gauge);
  std::vector<ObservedRow> rows;
  for (std::size_t r = 0; r < table.size(); ++r)
    if (table.counts(r)) rows.push_back({table.value(r, "time"), 0, table.values(r, columns), table.sigma(r), table.line(r)});
  return rows;
}

}  // namespace jaxmpm
