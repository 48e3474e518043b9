#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Of DIS (Kroeger et al., 2016): fast is cheaper and coarser.
enum class FlowPreset { medium, fast };

/// Optical flow (DIS) in pixels: from(p) looks as to(p + flow(p)). Both images are of one size, at least kLeastFlowSide each
/// way.
cv::Mat2f optical_flow(const cv::Mat1b& from, const cv::Mat1b& to, FlowPreset preset = FlowPreset::medium);

inline constexpr int kLeastFlowSide = 32;  ///< px; DIS needs some pyramid

}  // namespace dvi
