#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace dvi {

/// Generates random numbers by SplitMix64 (Steele et al., 2014). Unlike the distributions of <random>, the numbers are the same
/// on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Returns a number in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Returns a number in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Returns a whole number in [0, count).
  int below(int count) { return static_cast<int>(uniform() * count); }
  /// Returns a number of the standard normal distribution (Box-Muller).
  double normal() {
    const double r = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return r * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace dvi
