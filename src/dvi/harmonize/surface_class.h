#pragma once

#include <cstdint>

namespace dvi::harmonize {

/// The surface that a pixel shows: the ground, or one that is more than the height of a curb above it or above the horizon.
enum class SurfaceClass : std::uint8_t { unknown, ground, upright };

/// Whether two classes are known and different, so that colors do not continue from one to the other.
constexpr bool are_different(SurfaceClass a, SurfaceClass b) {
  return a != b && a != SurfaceClass::unknown && b != SurfaceClass::unknown;
}

}  // namespace dvi::harmonize
