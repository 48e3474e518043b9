#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace dvi::media {

/// Reads a number of type T at a place that may be unaligned, with its bytes in reverse order if `swap`.
template <class T>
double load_number(const char* at, bool swap) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), at, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<T>(raw));
}

/// Returns the number of a beam, limited to 16 bits. The order of the arguments turns NaN into 0.
inline std::uint16_t to_ring(double value) { return static_cast<std::uint16_t>(std::max(0.0, std::min(value, 65535.0))); }

}  // namespace dvi::media
