#pragma once

#include <cstddef>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::baselines {

/// How the scene behind the masks moves between two frames, on a grid of every second pixel: their optical flow (DIS, both
/// ways), in and near the masks of either continued from around them as a thin plate.
struct HoleFlow {
  cv::Mat2f forth, back;  ///< px of the image, from the first frame to the second and back; NaN: the two disagree

  std::size_t bytes() const { return bytes_of(forth) + bytes_of(back); }
  /// The motion of a position of the image; none outside it and where the flow is not trusted.
  static std::optional<cv::Point2f> at(const cv::Mat2f& flow, cv::Point2f position);
};

/// `consistency_px`: how far from where it began a pixel may end that moves forth and back.
HoleFlow hole_flow(const cv::Mat3b& first, const cv::Mat1b& first_mask, const cv::Mat3b& second, const cv::Mat1b& second_mask,
                   double consistency_px);

}  // namespace dvi::baselines
