#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace dvi::harmonize {

/// Where a pixel of the result comes from; the values of kind/NAME.png.
enum class Kind : std::uint8_t { original = 0, copied = 1, copied_elsewhere = 2, interpolated = 3, synthesized = 4, empty = 5 };

/// A frame with its hole filled, and the receipt of each pixel.
struct FilledFrame {
  cv::Mat3f color;                 ///< BGR 0..255; outside the hole exactly the input
  cv::Mat1b mask;                  ///< 255 = was removed
  cv::Mat1b kind;                  ///< Kind
  cv::Mat_<cv::Vec3w> provenance;  ///< source number + 1 (0: none), x * 16, y * 16
  cv::Mat3b used;                  ///< footprint's height and width (1: a pixel), number of sources averaged; zeros: not copied
  cv::Mat1b confidence;            ///< 255 = certain to be within 10 gray levels of the truth
  cv::Mat1f depth;                 ///< as DepthMap::z; what only another drive shows, as sky, is at infinity
  cv::Vec3f gain{1, 1, 1};         ///< as View::gain
};

}  // namespace dvi::harmonize
