#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

namespace dvi {

/// A scan of a rotating LiDAR with 16 rings, in a street 16 m wide between walls; points are ordered by ring.
struct TestScan {
  static constexpr int kRings = 16, kSteps = 360;
  std::vector<double> x, y, z, intensity, ring, t;

  explicit TestScan(double period_s = 0.1) {
    for (int i = 0; i < kRings; ++i)
      for (int step = 0; step < kSteps; ++step) {
        const double turn = (step + 0.5) / kSteps, azimuth = std::numbers::pi * (1 - 2 * turn);
        const double elevation = (-15 + 2 * i) * std::numbers::pi / 180;
        const double wall = 8 / std::max(std::abs(std::sin(azimuth)), 0.1);
        const double ground = elevation < 0 ? 1.7 / std::tan(-elevation) : 1e3;
        const double range = std::min(wall, ground);
        x.push_back(range * std::cos(azimuth)), y.push_back(range * std::sin(azimuth)),
            z.push_back(range * std::tan(elevation));
        intensity.push_back((ground < wall ? 20 : 90) + 7 * std::sin(12.3 * i + 4.5 * step));
        ring.push_back(i), t.push_back(period_s * turn);
      }
  }
};

/// Returns the bytes of a .bin file with these columns.
template <class Scalar>
std::string bin_of(const std::vector<std::vector<double>>& columns) {
  std::string bytes;
  for (std::size_t i = 0; i < columns.front().size(); ++i)
    for (const std::vector<double>& column : columns) {
      const auto value = static_cast<Scalar>(column[i]);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  return bytes;
}

}  // namespace dvi
