#pragma once

#include <cstdint>

namespace dvi::harmonize {

/// What a pixel shows: the ground, or what stands more than a curb's height above it or lies beyond its horizon.
enum class SurfaceClass : std::uint8_t { unknown, ground, upright };

/// Whether colors of one class do not go on in the other.
constexpr bool differ(SurfaceClass a, SurfaceClass b) {
  return a != b && a != SurfaceClass::unknown && b != SurfaceClass::unknown;
}

}  // namespace dvi::harmonize
