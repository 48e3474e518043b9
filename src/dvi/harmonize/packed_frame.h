#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/harmonize/filled_frame.h"

namespace dvi::harmonize {

/// A filled frame in less memory, without loss: all but its mask and depth is stored for the pixels of the hole only.
class PackedFrame {
 public:
  PackedFrame() = default;
  explicit PackedFrame(const FilledFrame& frame);

  /// Restores the frame from its input image. It shares the mask and the depth with the packed frame.
  FilledFrame unpack(const cv::Mat3b& image) const;
  std::size_t bytes() const;

 private:
  struct Pixel {
    cv::Vec3f color;
    cv::Vec3w provenance;
    cv::Vec3b used;
    uchar kind = 0, confidence = 0;
  };
  std::vector<Pixel> hole_;  // in raster order
  cv::Mat1b mask_;
  cv::Mat1f depth_;
  cv::Vec3f gain_{1, 1, 1};
};

}  // namespace dvi::harmonize
