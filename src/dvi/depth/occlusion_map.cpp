#include "dvi/depth/occlusion_map.h"

#include <cmath>

namespace dvi {

OcclusionMap occlusion_map(const DepthMap& depth) {
  const cv::Size full = depth.z.size();
  OcclusionMap out{cv::Mat1w((full.height + 1) / 2, (full.width + 1) / 2, OcclusionMap::kNone)};
  for (int y = 0; y < out.farthest.rows; ++y)
    for (int x = 0; x < out.farthest.cols; ++x) {
      float far = 0;
      for (int v = std::max(0, 2 * y - 1); v <= std::min(full.height - 1, 2 * y + 2); ++v)
        for (int u = std::max(0, 2 * x - 1); u <= std::min(full.width - 1, 2 * x + 2); ++u)
          far = std::max(far, depth.z(v, u) == DepthMap::kUnknown ? DepthMap::kSky : depth.z(v, u));
      if (far * OcclusionMap::kScale < OcclusionMap::kNone)
        out.farthest(y, x) = static_cast<ushort>(std::ceil(far * OcclusionMap::kScale));
    }
  return out;
}

}  // namespace dvi
