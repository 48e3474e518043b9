#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"

namespace dvi::depth {

/// A depth map in less memory, without loss of the depths: equal pixels (sky, unknown) are stored as runs, and standard
/// deviations are stored for the pixels of the hole only.
class PackedDepth {
 public:
  PackedDepth() = default;
  PackedDepth(const DepthMap& depth, const cv::Mat1b& hole);

  /// Restores the depth map. `hole` must be the one of the constructor; `sigma` is 0 outside it.
  DepthMap unpack(const cv::Mat1b& hole) const;
  std::size_t bytes() const;

 private:
  /// Consecutive pixels in raster order: `same` pixels equal to `value`, then `values` pixels that are stored individually.
  struct Run {
    float value = 0;
    std::uint32_t same = 0, values = 0;
  };
  std::vector<Run> runs_;
  std::vector<float> z_, sigma_;
};

}  // namespace dvi::depth
