#pragma once

#include <cmath>
#include <optional>

#include "dvi/drive/view.h"
#include "dvi/image/interpolate.h"

namespace dvi {

/// Maps pixels of a target view by their depth to the image of a source view.
class Warp {
 public:
  Warp(const View& target, const View& source)
      : target_(&target.camera),
        source_(&source.camera),
        source_from_target_(source.camera_from_world * target.camera_from_world.inverse()) {}

  /// Returns the quantized position, which may lie outside the source's image. `z` is the depth in meters, infinity for the
  /// sky. Returns nothing if the depth is unknown (z <= 0) or if the point is not in front of the source.
  std::optional<cv::Point2f> operator()(cv::Point pixel, float z) const {
    if (!(z > 0)) return std::nullopt;
    const Eigen::Vector3d ray = target_->ray({pixel.x, pixel.y});
    const Eigen::Vector3d x = std::isinf(z) ? source_from_target_.R * ray : source_from_target_ * (z * ray);
    if (!source_->in_front(x)) return std::nullopt;
    const Eigen::Vector2d at = source_->project(x);
    return quantize(at.x(), at.y());
  }

 private:
  const Camera *target_, *source_;
  SE3 source_from_target_;
};

/// A pixel of a target view, and its position in a source by its own depth; none if the depth is unknown.
struct WarpedPixel {
  cv::Point pixel;
  std::optional<cv::Point2f> in_source;
};

/// Returns the position in a source frame of the neighbor `q` of pixel `p`, which was copied from `p_from`: q is shifted like
/// p. If a depth is unknown, adds the offset of the pixels to p_from.
inline cv::Point2f find_neighbor_in_source(const WarpedPixel& p, cv::Point2f p_from, const WarpedPixel& q) {
  if (p.in_source && q.in_source) return p_from + (*q.in_source - *p.in_source);
  return p_from + cv::Point2f(q.pixel - p.pixel);
}

/// Returns whether bilinear interpolation at this position stays within the image and outside its mask (255 = remove).
inline bool can_sample(const cv::Mat1b& mask, cv::Point2f at) {
  if (!(at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(mask.cols - 1) && at.y <= static_cast<float>(mask.rows - 1)))
    return false;
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const int x1 = static_cast<int>(std::ceil(at.x)), y1 = static_cast<int>(std::ceil(at.y));
  return (mask(y, x) | mask(y, x1) | mask(y1, x) | mask(y1, x1)) == 0;
}

/// Does the same for box_mean().
inline bool can_sample(const cv::Mat1b& mask, cv::Point2f at, cv::Vec2b footprint) {
  const cv::Point2f first = at - 0.5F * cv::Point2f(static_cast<float>(footprint[0] - 1), static_cast<float>(footprint[1] - 1));
  for (int y = 0; y < footprint[1]; ++y)
    for (int x = 0; x < footprint[0]; ++x)
      if (!can_sample(mask, first + cv::Point2f(static_cast<float>(x), static_cast<float>(y)))) return false;
  return true;
}

}  // namespace dvi
