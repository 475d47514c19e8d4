#pragma once
// Our own random numbers, so that the same seed gives the same scene whatever the standard library: SplitMix64 (Steele, Lea & Flood 2014,
// Fig. 16) and normal deviates by Box & Muller (1958).
#include <cmath>
#include <cstdint>

namespace jaxmpm {

class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}
  /// A stream of its own for each (seed, index), so that draws do not depend on order.
  RandomStream(std::uint64_t seed, std::uint64_t index) : state_(seed) { state_ = next() ^ (index * 0xD1B54A32D192ED03ULL + 1); }

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1), from the upper 53 bits.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Standard normal deviate.
  double normal() {
    const double kTwoPi = 6.283185307179586476925;
    const double u = 1.0 - uniform(), v = uniform();  // u > 0
    return std::sqrt(-2.0 * std::log(u)) * std::cos(kTwoPi * v);
  }

 private:
  std::uint64_t state_;
};

}  // namespace jaxmpm
