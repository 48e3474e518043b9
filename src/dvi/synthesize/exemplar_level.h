#pragma once

#include <cmath>

#include <opencv2/core/mat.hpp>

namespace dvi::synthesize {

/// One level of the image pyramid in which exemplars are searched.
struct ExemplarLevel {
  float scale = 1;      ///< Width of a pixel in pixels of the finest level.
  cv::Mat4f color;      ///< BGR and 0.
  cv::Mat1b unknown;    ///< 255: to be completed.
  cv::Mat1b usable;     ///< 255: may be an exemplar.
  cv::Mat1b group;      ///< As in the guide.
  cv::Mat2f ground;     ///< As in the guide.
  cv::Mat4f slope;      ///< Derivative of `ground` by x and y: along/x, left/x, along/y, left/y.
  cv::Mat4f prior;      ///< The smooth color that an exemplar should have on average, in unknown pixels.
  cv::Mat1f clearance;  ///< Largest radius of a square around the pixel that has exemplar pixels only.

  cv::Size size() const { return color.size(); }
  bool is_ground(cv::Point p) const { return !std::isnan(ground(p)[0]); }
};

/// Computes `slope` and `clearance` from the other fields. Pixels without a slope are no longer on the ground.
void derive_level(ExemplarLevel& level);

/// Halves the resolution of a level. A pixel is known if half of its pixels are, and has their mean color.
ExemplarLevel halve(const ExemplarLevel& fine);

}  // namespace dvi::synthesize
