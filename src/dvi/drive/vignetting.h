#pragma once

#include <algorithm>
#include <cmath>

#include <opencv2/core/types.hpp>

#include "dvi/drive/view.h"
#include "dvi/image/saturation.h"

namespace dvi {

/// Computes -ln cos^2 of the angle between a pixel's ray and the optical axis, for an image without distortion.
inline float compute_off_axis(const Camera& camera, cv::Point2f p) {
  const double x = (p.x - camera.cx) / camera.fx, y = (p.y - camera.cy) / camera.fy;
  return static_cast<float>(std::log1p(x * x + y * y));
}

/// Computes the brightness of a pixel relative to the center of the image: cos^(2 k) of that angle, where k is
/// View::vignetting. By the cos^4 law, k is 2 in linear light and about 1 in the colors of images.
inline float vignetting(const View& view, cv::Point2f p) {
  return view.vignetting == 0 ? 1 : std::exp(-view.vignetting * compute_off_axis(view.camera, p));
}

/// Returns the factor from a color at a pixel of one view to a pixel of another view, in addition to gain_to().
inline float vignetting_to(const View& target, cv::Point2f to, const View& source, cv::Point2f from) {
  return target.vignetting == 0 && source.vignetting == 0 ? 1 : vignetting(target, to) / vignetting(source, from);
}

/// Multiplies a color by this factor. Saturated colors are lower bounds and are therefore not darkened.
inline cv::Vec3f apply_vignetting(const cv::Vec3f& color, float by) {
  return (is_saturated(color) ? std::max(by, 1.0F) : by) * color;
}

}  // namespace dvi
