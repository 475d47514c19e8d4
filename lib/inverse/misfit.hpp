#pragma once
// How far the run of the best values is from the data of an observation, and whether what is left looks like noise.
#include <limits>

#include "inverse/observer.hpp"

namespace jaxmpm {

/// Differences read − observed of one observation, over all its numbers that could be read.
struct Misfit {
  double rms = 0, mean = 0, largest = 0;  // in the unit of the data
  double spread = 0;                      // standard deviation of the data themselves
  std::size_t unread = 0;                 // rows
  /// Correlation of neighbouring differences (over their σ): of a subject from time to time; of a profile at one time from place to place;
  /// NaN where nothing has a neighbour. Independent noise has 0 ± 1/√pairs, what a model cannot follow comes near 1 (Durbin & Watson 1950,
  /// whose statistic is 2 (1 − correlation)).
  double correlation = std::numeric_limits<double>::quiet_NaN();
  std::size_t pairs = 0;

  /// Whether there are pairs enough to tell noise from what the model leaves out, and more than a trace (1e-4 of the spread) is left at all.
  bool can_tell() const { return pairs >= fewest_pairs && rms > 1e-4 * spread; }
  /// Whether the differences are no noise: standard errors, which take them for noise, then say too little.
  bool is_no_noise() const { return can_tell() && correlation > largest_of_noise(); }
  /// Correlation that noise hardly ever passes: three deviations, and no less than what would matter.
  double largest_of_noise() const;

  static constexpr std::size_t fewest_pairs = 10;
};

Misfit misfit_of(const Comparison& comparison);

}  // namespace jaxmpm
