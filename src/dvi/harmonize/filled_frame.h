#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace dvi::harmonize {

/// How a pixel of the result was obtained; the values of kind/NAME.png. No source observed the pixels from `interpolated` on.
enum class Kind : std::uint8_t {
  original = 0,
  copied = 1,
  copied_elsewhere = 2,
  interpolated = 3,
  synthesized = 4,
  empty = 5,
  imported = 6  ///< Filled by another program, after the run.
};

/// Whether no source observed a pixel of this kind.
inline bool is_unobserved(std::uint8_t kind) { return kind >= static_cast<std::uint8_t>(Kind::interpolated); }

/// A frame with its hole filled, and the provenance of each pixel.
struct FilledFrame {
  cv::Mat3f color;                 ///< BGR, 0..255; outside the hole it is exactly the input.
  cv::Mat1b mask;                  ///< 255: the pixel was removed.
  cv::Mat1b kind;                  ///< Values of Kind.
  cv::Mat_<cv::Vec3w> provenance;  ///< Index of the source + 1 (0: none), x * 16, y * 16.
  cv::Mat3b used;                  ///< Height and width of the footprint in pixels, number of averaged sources; 0: not copied.
  cv::Mat1b confidence;            ///< Probability of being within 10 gray levels of the truth; 255: certain.
  cv::Mat1f depth;                 ///< Values of DepthMap::z; pixels that only another drive shows, as sky, are at infinity.
  cv::Vec3f gain{1, 1, 1};         ///< The gain of the view.
};

/// Makes a frame of which no pixel is filled, from its image, mask, depth, and gain. It refers to the mask and the depth.
FilledFrame make_unfilled_frame(const cv::Mat3b& image, const cv::Mat1b& mask, const cv::Mat1f& depth, const cv::Vec3f& gain);

}  // namespace dvi::harmonize
