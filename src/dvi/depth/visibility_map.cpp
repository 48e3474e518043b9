#include "dvi/depth/visibility_map.h"

#include <cmath>

#include "dvi/image/region.h"

namespace dvi {

VisibilityMap visibility_map(const DepthMap& depth, const cv::Mat1b& mask, int mask_margin_px) {
  const cv::Mat1b lent = grown(mask, mask_margin_px);
  const cv::Size full = depth.z.size();
  VisibilityMap out{cv::Mat1w((full.height + 1) / 2, (full.width + 1) / 2, VisibilityMap::kOpen)};
  for (int y = 0; y < out.farthest.rows; ++y)
    for (int x = 0; x < out.farthest.cols; ++x) {
      float far = 0;
      uchar masked = 0;
      for (int v = std::max(0, 2 * y - 1); v <= std::min(full.height - 1, 2 * y + 2); ++v)
        for (int u = std::max(0, 2 * x - 1); u <= std::min(full.width - 1, 2 * x + 2); ++u) {
          far = std::max(far, depth.z(v, u) == DepthMap::kUnknown ? DepthMap::kSky : depth.z(v, u));
          masked |= lent(v, u);
        }
      if (masked != 0)
        out.farthest(y, x) = VisibilityMap::kMasked;
      else if (far * VisibilityMap::kScale < VisibilityMap::kOpen)
        out.farthest(y, x) = static_cast<ushort>(std::ceil(far * VisibilityMap::kScale));
    }
  return out;
}

}  // namespace dvi
