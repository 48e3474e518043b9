#pragma once

#include <numbers>

namespace dvi {

inline constexpr double kRadPerDegree = std::numbers::pi / 180;

/// Converts an angle from radians to degrees.
constexpr double to_degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Converts an angle from degrees to radians.
constexpr double to_radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace dvi
