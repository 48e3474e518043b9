#include "dvi/objects/half_size.h"

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"

namespace dvi::objects {

HalfView half_view(const cv::Mat3b& image, const cv::Mat1b& mask, int blur) {
  HalfView out;
  const cv::Size size(image.cols / kScale, image.rows / kScale);
  cv::Mat3b half;
  cv::resize(image, half, size, 0, 0, cv::INTER_AREA);
  if (blur > 1) cv::blur(half, half, {blur, blur});
  half.convertTo(out.image, CV_32FC3);
  cv::resize(grown(mask, kScale), out.mask, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

Eigen::Vector2d full_size(cv::Point half) {
  return {kScale * half.x + 0.5 * (kScale - 1), kScale * half.y + 0.5 * (kScale - 1)};
}

cv::Point2f half_size(const Eigen::Vector2d& full) {
  return {static_cast<float>((full.x() - 0.5 * (kScale - 1)) / kScale),
          static_cast<float>((full.y() - 0.5 * (kScale - 1)) / kScale)};
}

}  // namespace dvi::objects
