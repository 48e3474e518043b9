#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dvi::media {

/// Compresses bytes into the zlib format (RFC 1950), optimized for speed.
std::string compress_zlib(const std::vector<std::uint8_t>& bytes);

}  // namespace dvi::media
