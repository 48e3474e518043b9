#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <opencv2/core/types.hpp>

namespace dvi::labels {

/// COCO's compressed run lengths, as MOTS has them too. std::invalid_argument with the reason.
std::vector<std::uint32_t> decode_runs(std::string_view text);

/// std::invalid_argument where the runs are not as many pixels as an image of `size` has.
void require_filled(const std::vector<std::uint32_t>& runs, cv::Size size);

}  // namespace dvi::labels
