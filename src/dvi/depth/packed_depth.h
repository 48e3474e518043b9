#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"

namespace dvi::depth {

/// A depth map without loss in less memory, for views that are targets later: pixels alike (sky, unknown) as runs, and the
/// standard deviations only of the pixels that are to be filled.
class PackedDepth {
 public:
  PackedDepth() = default;
  PackedDepth(const DepthMap& depth, const cv::Mat1b& hole);

  /// `hole` as it was packed with; outside of it sigma is 0.
  DepthMap unpack(const cv::Mat1b& hole) const;
  std::size_t bytes() const;

 private:
  /// Pixels in raster order: `same` times `value`, then `values` that differ.
  struct Run {
    float value = 0;
    std::uint32_t same = 0, values = 0;
  };
  std::vector<Run> runs_;
  std::vector<float> z_, sigma_;
};

}  // namespace dvi::depth
