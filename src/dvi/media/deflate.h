#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dvi::media {

/// The bytes in the zlib format (RFC 1950), compressed for speed.
std::string zlib_compressed(const std::vector<std::uint8_t>& bytes);

}  // namespace dvi::media
