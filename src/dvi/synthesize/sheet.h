#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::synthesize {

/// A surface of the world, unrolled: columns along the road, rows across it.
struct Sheet {
  cv::Mat3f color;  ///< BGR, in the light common to all views; zeros where not known
  cv::Mat1b known;  ///< 255

  Sheet() = default;
  explicit Sheet(cv::Size size) : color(size, cv::Vec3f()), known(size, uchar{0}) {}
  std::size_t bytes() const { return color.total() * (sizeof(cv::Vec3f) + 1); }
};

/// Completes what is not known from what the same surface shows at other places, by dominant offsets (He and Sun 2012): each
/// pixel takes its color `offset` away. Of several offsets the one is taken by which the known surroundings, over a Gaussian
/// of `reach` pixels, repeat best. What is taken is joined without steps, by its ratios (eq. 5 in logarithms). A round of
/// offsets is asked after the other, for what is still missing; offsets are multiples of 4.
void complete(Sheet& sheet, const std::vector<std::vector<cv::Point>>& rounds, double reach);

}  // namespace dvi::synthesize
