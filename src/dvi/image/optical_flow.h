#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// The presets of DIS (Kroeger et al., 2016): `fast` is cheaper and coarser.
enum class FlowPreset { medium, fast };

/// Computes the optical flow (DIS) in pixels: from(p) corresponds to to(p + flow(p)). Both images must have the same size, with
/// sides of at least kMinFlowSidePx.
cv::Mat2f compute_optical_flow(const cv::Mat1b& from, const cv::Mat1b& to, FlowPreset preset = FlowPreset::medium);

inline constexpr int kMinFlowSidePx = 32;  ///< pixels; DIS needs an image pyramid

}  // namespace dvi
