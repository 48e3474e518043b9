#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <opencv2/core/types.hpp>

namespace dvi::labels {

/// Decodes COCO's compressed run lengths, which MOTS uses as well. Throws std::invalid_argument with the reason if they are
/// malformed.
std::vector<std::uint32_t> decode_runs(std::string_view text);

/// Throws std::invalid_argument unless the runs cover exactly the pixels of an image of `size`.
void require_filled(const std::vector<std::uint32_t>& runs, cv::Size size);

}  // namespace dvi::labels
