#include "inverse/observed_rows.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fields/files.hpp"
#include "fields/random.hpp"
#include "scene/frame.hpp"

namespace jaxmpm {
namespace {

constexpr double same_time = 1e-9;  // relative to the end of the run, and to `every`

void sort_rows(std::vector<ObservedRow>& rows, const ObservationPlace& place) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const ObservedRow& a, const ObservedRow& b) { return a.time != b.time ? a.time < b.time : a.subject < b.subject; });
  for (std::size_t r = 1; r < rows.size(); ++r)
    if (rows[r].time == rows[r - 1].time && rows[r].subject == rows[r - 1].subject)
      place.bad_file(rows[r].line, "a second row of the same thing at " + number_text(rows[r].time) + " s");
  if (!rows.empty() && rows.front().time < 0)
    place.bad_file(rows.front().line, "the time " + number_text(rows.front().time) + " s is before the run's start at 0 s");
}

}  // namespace

void ObservationPlace::bad_file(int line, const std::string& message) const { ::jaxmpm::bad_file(pointer + "/file", file, line, message); }

std::vector<ObservedRow> within_window(std::vector<ObservedRow> rows, const deck::Observed& observed, const ObservationPlace& place) {
  if (rows.empty()) place.bad_file(0, "no row is left by the selection and the mask; nothing would be observed");
  sort_rows(rows, place);
  const double first = rows.front().time, last = rows.back().time, tolerance = same_time * place.end;
  const double from = observed.from_time.value_or(first), to = std::min(observed.to_time.value_or(place.end), place.end);
  const auto late = std::find_if(rows.begin(), rows.end(), [&](const ObservedRow& r) { return r.time > place.end + tolerance; });
  if (late != rows.end() && !observed.to_time) {
    if (late->line > 0 && first <= to + tolerance)  // the results of a longer run may go on
      place.bad_file(late->line, "the time " + number_text(late->time) + " s is after the run's end at " + number_text(place.end) +
                                     " s; make /time/end later, or leave such rows out by to_time");
    spdlog::info("{}: {} of {} rows of '{}' are of times after the run's end at {} s, and are left out.", place.pointer, rows.end() - late,
                 rows.size(), place.file, number_text(place.end));
  }
  std::vector<ObservedRow> kept;
  double start = 0, counted = -1;  // the first time kept, and the last multiple of `every` that has had its time
  for (ObservedRow& row : rows) {
    if (row.time < from - tolerance || row.time > to + tolerance) continue;
    row.time = std::min(row.time, place.end);
    if (kept.empty()) start = row.time;
    if (observed.every && (kept.empty() || row.time != kept.back().time)) {
      const double multiple = std::floor((row.time - start) / *observed.every + same_time);
      if (multiple == counted) continue;
      counted = multiple;
    }
    kept.push_back(std::move(row));
  }
  if (kept.empty() && first > to + tolerance)
    place.bad_file(0, "all rows (" + number_text(first) + " s to " + number_text(last) + " s) lie after " + number_text(to) +
                          " s, where the run or the observation ends; times are in seconds from the start of the run");
  if (kept.empty())
    place.bad_file(0, "no row lies between " + number_text(from) + " s and " + number_text(to) +
                          " s, where the run is observed; the rows are from " + number_text(first) + " s to " + number_text(last) + " s");
  return kept;
}

ObservedData grouped(std::vector<ObservedRow> rows, std::optional<double> average) {
  std::map<std::pair<double, std::size_t>, std::size_t> groups;  // by window and subject, in the order of their first rows
  std::size_t own = 0;
  for (ObservedRow& row : rows)
    row.group =
        average
            ? groups.try_emplace({std::floor((row.time - rows[0].time) / *average + same_time), row.subject}, groups.size()).first->second
            : own++;
  return {std::move(rows), average ? groups.size() : own};
}

void add_noise(std::vector<ObservedRow>& rows, const std::optional<deck::Noise>& noise, std::size_t index) {
  if (!noise) return;
  RandomStream random(noise->seed, index);
  for (ObservedRow& row : rows)
    for (double& value : row.value) value += noise->deviation * random.normal();
}

bool in_box(const deck::Box& box, const double* x) {
  for (std::size_t a = 0; a < box.min.size(); ++a)
    if (x[a] < box.min[a] || x[a] > box.max[a]) return false;
  return true;
}

}  // namespace jaxmpm
