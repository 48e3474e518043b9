#pragma once

#include <cstddef>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::baselines {

/// The optical flow of the background between two frames (DIS, in both directions), on a grid of every second pixel. In and
/// near the masks of both frames, it is extrapolated from the surroundings as a thin plate.
struct HoleFlow {
  cv::Mat2f forward, backward;  ///< px of the image, from the first frame to the second, and back; NaN if inconsistent

  std::size_t bytes() const { return bytes_of(forward) + bytes_of(backward); }
  /// Interpolates the motion at a position in the image; nothing outside the image or if the flow is inconsistent.
  static std::optional<cv::Point2f> interpolate(const cv::Mat2f& flow, cv::Point2f position);
};

/// Parameters of the flow.
struct HoleFlowParams {
  int step_px = 2;                 ///< distance of the grid points
  int margin_px = 8;               ///< size of the patches of DIS, within which masked pixels affect the flow
  int band = 8;                    ///< grid points around the masks whose flow is extrapolated into them
  double data_weight = 1 / 256.0;  ///< relative to the bending energy: smooths noise finer than 4 grid points
};
inline constexpr HoleFlowParams kHoleFlow;

/// An image and the mask of its hole. It holds references only, and is constructed for one call.
struct HoleImage {
  const cv::Mat3b& colors;
  const cv::Mat1b& mask;
};

/// Computes the flow. `consistency_px` is the largest error of the forward-backward check.
HoleFlow compute_hole_flow(const HoleImage& first, const HoleImage& second, double consistency_px);

}  // namespace dvi::baselines
