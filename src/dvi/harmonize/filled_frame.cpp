#include "dvi/harmonize/filled_frame.h"

namespace dvi::harmonize {

FilledFrame make_unfilled_frame(const cv::Mat3b& image, const cv::Mat1b& mask, const cv::Mat1f& depth, const cv::Vec3f& gain) {
  FilledFrame out;
  image.convertTo(out.color, CV_32FC3);
  out.mask = mask;
  out.kind = cv::Mat1b(image.size(), static_cast<uchar>(Kind::original));
  out.provenance = cv::Mat_<cv::Vec3w>(image.size(), cv::Vec3w());
  out.used = cv::Mat3b(image.size(), cv::Vec3b());
  out.confidence = cv::Mat1b(image.size(), uchar{255});
  out.depth = depth;
  out.gain = gain;
  return out;
}

}  // namespace dvi::harmonize
