#pragma once

#include <algorithm>
#include <cmath>

#include <opencv2/core/types.hpp>

#include "dvi/drive/view.h"
#include "dvi/image/saturation.h"

namespace dvi {

/// -ln cos^2 of the angle between a pixel's ray and the optical axis (of an image without distortion).
inline float off_axis(const Camera& camera, cv::Point2f p) {
  const double x = (p.x - camera.cx) / camera.fx, y = (p.y - camera.cy) / camera.fy;
  return static_cast<float>(std::log1p(x * x + y * y));
}

/// How bright the lens shows a pixel, the center of the image being 1: cos^(2 k) of that angle, k being View::vignetting. By
/// the cos^4 law k is 2 in linear light, about half of that in the colors of images.
inline float vignetting(const View& view, cv::Point2f p) {
  return view.vignetting == 0 ? 1 : std::exp(-view.vignetting * off_axis(view.camera, p));
}

/// What brings a color from one pixel of a view to another one of another view, beside gain_to().
inline float vignetting_to(const View& target, cv::Point2f to, const View& source, cv::Point2f from) {
  return target.vignetting == 0 && source.vignetting == 0 ? 1 : vignetting(target, to) / vignetting(source, from);
}

/// A color times that. What is saturated is known from below only: it is not darkened.
inline cv::Vec3f vignetted(const cv::Vec3f& color, float by) { return (is_saturated(color) ? std::max(by, 1.0F) : by) * color; }

}  // namespace dvi
