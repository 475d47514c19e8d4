#include "scene/spans.hpp"

#include <algorithm>

namespace jaxmpm {

bool contains(const Spans& spans, double coordinate) {
  return std::any_of(spans.begin(), spans.end(), [&](const Span& s) { return s.lower <= coordinate && coordinate < s.upper; });
}

Spans unite(const Spans& a, const Spans& b) {
  Spans all(a);
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(), [](const Span& s, const Span& t) { return s.lower < t.lower; });
  Spans merged;
  for (const Span& s : all) {
    if (!merged.empty() && s.lower <= merged.back().upper) merged.back().upper = std::max(merged.back().upper, s.upper);
    else merged.push_back(s);
  }
  return merged;
}

Spans subtract(const Spans& a, const Spans& b) {
  Spans rest;
  for (Span s : a) {
    for (const Span& hole : b) {
      if (hole.upper <= s.lower || hole.lower >= s.upper) continue;
      if (hole.lower > s.lower) rest.push_back({s.lower, hole.lower});
      s.lower = hole.upper;
    }
    if (s.lower < s.upper) rest.push_back(s);
  }
  return rest;
}

}  // namespace jaxmpm
