#include "inverse/misfit.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace jaxmpm {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// For each row its neighbour before: the same subject's at the time before, or where subjects have one time each, that of the place before.
std::vector<std::size_t> rows_before(const Comparison& comparison) {
  const std::size_t rows = comparison.time.size();
  std::vector<std::size_t> before(rows, none);
  std::map<std::size_t, std::size_t> last;  // row of a subject
  bool again = false;
  for (std::size_t r = 0; r < rows; ++r) {
    const auto [at, first] = last.try_emplace(comparison.subject[r], r);
    if (!first) before[r] = at->second, at->second = r, again = true;
  }
  for (std::size_t r = 1; r < rows && !again && !comparison.places.empty(); ++r)
    if (comparison.time[r] == comparison.time[r - 1]) before[r] = r - 1;
  return before;
}

void find_correlation(const Comparison& comparison, Misfit& misfit) {
  const std::vector<std::size_t> before = rows_before(comparison);
  const auto difference = [&](std::size_t row, std::size_t k) {
    const std::size_t i = row * comparison.width + k;
    return (comparison.read[i] - comparison.observed[i]) / comparison.sigma[row];
  };
  double products = 0, squares = 0;
  for (std::size_t r = 0; r < before.size(); ++r)
    for (std::size_t k = 0; k < comparison.width && before[r] != none; ++k) {
      const double a = difference(before[r], k), b = difference(r, k);
      if (std::isnan(a) || std::isnan(b)) continue;
      products += a * b, squares += 0.5 * (a * a + b * b), ++misfit.pairs;
    }
  if (squares > 0) misfit.correlation = products / squares;
}

}  // namespace

double Misfit::largest_of_noise() const {
  constexpr double deviations = 3, matters = 0.2;
  return std::max(matters, deviations / std::sqrt(static_cast<double>(pairs)));
}

Misfit misfit_of(const Comparison& comparison) {
  Misfit misfit;
  std::size_t count = 0;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < comparison.read.size(); ++i) {
    const double observed = comparison.observed[i], difference = comparison.read[i] - observed;
    if (std::isnan(difference)) {
      misfit.unread += i % comparison.width == 0;
      continue;
    }
    misfit.rms += difference * difference, misfit.mean += difference, ++count;
    misfit.largest = std::max(misfit.largest, std::abs(difference));
    sum += observed, squares += observed * observed;
  }
  if (count == 0) return misfit;
  const auto n = static_cast<double>(count);
  misfit.rms = std::sqrt(misfit.rms / n), misfit.mean /= n;
  misfit.spread = std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)));
  find_correlation(comparison, misfit);
  return misfit;
}

}  // namespace jaxmpm
