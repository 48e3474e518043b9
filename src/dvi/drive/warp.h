#pragma once

#include <cmath>
#include <optional>

#include "dvi/drive/view.h"
#include "dvi/image/interpolate.h"

namespace dvi {

/// Takes pixels of a target view, with their depth, to where a source view shows them.
class Warp {
 public:
  Warp(const View& target, const View& source)
      : target_(&target.camera),
        source_(&source.camera),
        source_from_target_(source.camera_from_world * target.camera_from_world.inverse()) {}

  /// Quantized; may lie outside the source's image. Depth z in meters, infinity for the sky. None where the depth is
  /// unknown (z <= 0) or the point is not in front of the source.
  std::optional<cv::Point2f> operator()(cv::Point pixel, float z) const {
    if (!(z > 0)) return std::nullopt;
    const Eigen::Vector3d ray = target_->ray({pixel.x, pixel.y});
    const Eigen::Vector3d x = std::isinf(z) ? source_from_target_.R * ray : source_from_target_ * (z * ray);
    if (!source_->in_front(x)) return std::nullopt;
    const Eigen::Vector2d at = source_->project(x);
    return quantized(at.x(), at.y());
  }

 private:
  const Camera *target_, *source_;
  SE3 source_from_target_;
};

/// Where the source frame that shows pixel `p` at `p_in_source` shows its neighbor `q`: both are warped by their own depths
/// (`p_at`, `q_at`), and q is shifted as p_in_source is from p_at. Where a depth is unknown, q - p is added to p_in_source.
inline cv::Point2f neighbor_in_source(cv::Point p, cv::Point2f p_in_source, std::optional<cv::Point2f> p_at, cv::Point q,
                                      std::optional<cv::Point2f> q_at) {
  if (p_at && q_at) return p_in_source + (*q_at - *p_at);
  return p_in_source + cv::Point2f(q - p);
}

/// Whether bilinear interpolation at this position stays within the image and off its mask (255 = remove).
inline bool can_sample(const cv::Mat1b& mask, cv::Point2f at) {
  if (!(at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(mask.cols - 1) && at.y <= static_cast<float>(mask.rows - 1)))
    return false;
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const int x1 = static_cast<int>(std::ceil(at.x)), y1 = static_cast<int>(std::ceil(at.y));
  return (mask(y, x) | mask(y, x1) | mask(y1, x) | mask(y1, x1)) == 0;
}

/// The same for box_mean().
inline bool can_sample(const cv::Mat1b& mask, cv::Point2f at, cv::Vec2b footprint) {
  const cv::Point2f first = at - 0.5F * cv::Point2f(static_cast<float>(footprint[0] - 1), static_cast<float>(footprint[1] - 1));
  for (int y = 0; y < footprint[1]; ++y)
    for (int x = 0; x < footprint[0]; ++x)
      if (!can_sample(mask, first + cv::Point2f(static_cast<float>(x), static_cast<float>(y)))) return false;
  return true;
}

}  // namespace dvi
