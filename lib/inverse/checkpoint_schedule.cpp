#include "inverse/checkpoint_schedule.hpp"

#include <algorithm>
#include <vector>

namespace jaxmpm {
namespace {

/// C(s + r, s), or `enough` where it is larger; 0 for r < 0.
std::size_t reach(std::size_t s, long r, std::size_t enough) {
  if (r < 0) return 0;
  double value = 1;
  for (std::size_t k = 1; k <= std::min<std::size_t>(s, std::size_t(r)); ++k) {
    value *= double(s + std::size_t(r) - k + 1) / double(k);
    if (value >= double(enough)) return enough;
  }
  return std::size_t(value + 0.5);
}

}  // namespace

std::size_t steps_to_next_snapshot(std::size_t steps, std::size_t free) {
  long r = 1;
  while (reach(free, r, steps) < steps) ++r;
  // Both parts have to be within reach: the part ahead with one snapshot less, the part behind with one repetition less. Of the lengths
  // that allow that, those from `least` on cost the same up to the first that leaves the part ahead within reach of one repetition less.
  const std::size_t ahead = reach(free - 1, r, steps);
  const std::size_t least = std::max(steps > ahead ? steps - ahead : 0, reach(free, r - 2, steps));
  return std::clamp<std::size_t>(least, 1, steps - 1);
}

double recomputed_steps(std::size_t steps, std::size_t snapshots) {
  double forward = 0;
  std::vector<std::size_t> kept{0};
  for (std::size_t end = steps; end > 0;) {
    const std::size_t begin = kept.back();
    if (end - begin == 1) {
      if (end == steps) ++forward;  // the last step is done to see the end
      end = begin;
      kept.pop_back();
      continue;
    }
    const std::size_t go = steps_to_next_snapshot(end - begin, snapshots - kept.size());
    forward += double(go);
    kept.push_back(begin + go);
  }
  return forward - double(steps);
}

}  // namespace jaxmpm
