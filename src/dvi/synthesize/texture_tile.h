#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::synthesize {

/// A part of the road texture: a raster of the ground with columns along the road and rows across it.
struct TextureTile {
  cv::Mat3f color;  ///< BGR, in the common illumination of all views; zeros where it is unknown.
  cv::Mat1b known;  ///< 255 where the color is known.

  TextureTile() = default;
  explicit TextureTile(cv::Size size) : color(size, cv::Vec3f()), known(size, uchar{0}) {}
  std::size_t bytes() const { return color.total() * (sizeof(cv::Vec3f) + 1); }
};

/// Completes unknown pixels by dominant offsets (K. He and J. Sun, Statistics of patch offsets for image completion, ECCV
/// 2012): each takes the color of the pixel at an offset. Of several offsets, the one is selected at which the known
/// surroundings, over a Gaussian of `sigma_px`, differ least. The copies are blended without steps by their ratios (eq. 5 in
/// logarithms). The rounds of offsets are applied one after the other, to the pixels that are still unknown. Offsets must be
/// multiples of 4.
void complete(TextureTile& tile, const std::vector<std::vector<cv::Point>>& rounds, double sigma_px);

}  // namespace dvi::synthesize
