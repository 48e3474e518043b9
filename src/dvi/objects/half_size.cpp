#include "dvi/objects/half_size.h"

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"

namespace dvi::objects {

HalfSizeView make_half_size_view(const cv::Mat3b& image, const cv::Mat1b& mask, int blur_px) {
  HalfSizeView out;
  const cv::Size size(image.cols / kHalfSizeFactor, image.rows / kHalfSizeFactor);
  cv::resize(image, out.image, size, 0, 0, cv::INTER_AREA);
  if (blur_px > 1) cv::blur(out.image, out.image, {blur_px, blur_px});
  cv::resize(grown(mask, kHalfSizeFactor), out.mask, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

Eigen::Vector2d to_full_size(cv::Point half) {
  return {kHalfSizeFactor * half.x + 0.5 * (kHalfSizeFactor - 1), kHalfSizeFactor * half.y + 0.5 * (kHalfSizeFactor - 1)};
}

cv::Point2f to_half_size(const Eigen::Vector2d& full) {
  return {static_cast<float>((full.x() - 0.5 * (kHalfSizeFactor - 1)) / kHalfSizeFactor),
          static_cast<float>((full.y() - 0.5 * (kHalfSizeFactor - 1)) / kHalfSizeFactor)};
}

}  // namespace dvi::objects
