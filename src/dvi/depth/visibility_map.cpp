#include "dvi/depth/visibility_map.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi::depth {
namespace {

/// Whether a surface ends at a pixel. On a plane, 1/z is linear, so that its second difference vanishes.
bool is_at_edge(const cv::Mat1f& inverse, int x, int y) {
  constexpr float kMaxRelativeStep = 0.05F;  // larger than where triangles of one surface meet
  const float here = inverse(y, x);
  const float across = std::abs(inverse(y, x - 1) + inverse(y, x + 1) - 2 * here);
  const float along = std::abs(inverse(y - 1, x) + inverse(y + 1, x) - 2 * here);
  return std::max(across, along) > kMaxRelativeStep * here;
}

/// Computes the distance of each pixel to the mask, a depth edge, or the border.
cv::Mat1f measure_clearance(const DepthMap& depth, const cv::Mat1b& masked) {
  cv::Mat1f inverse(depth.z.size(), 0.0F);
  for (int y = 0; y < inverse.rows; ++y)
    for (int x = 0; x < inverse.cols; ++x)
      if (DepthMap::is_surface(depth.z(y, x))) inverse(y, x) = 1 / depth.z(y, x);
  cv::Mat1b inner(inverse.size(), uchar{0});
  for (int y = 1; y + 1 < inner.rows; ++y)
    for (int x = 1; x + 1 < inner.cols; ++x)
      if (masked(y, x) == 0 && !is_at_edge(inverse, x, y)) inner(y, x) = 255;
  cv::Mat1f out;
  cv::distanceTransform(inner, out, cv::DIST_L2, cv::DIST_MASK_3);
  return out;
}

}  // namespace

VisibilityMap make_visibility_map(const DepthMap& depth, const cv::Mat1b& mask) {
  const cv::Mat1f clearance = measure_clearance(depth, mask);
  const cv::Size full = depth.z.size(), blocks((full.width + 1) / 2, (full.height + 1) / 2);
  VisibilityMap out{cv::Mat1w(blocks, VisibilityMap::kNoSurface), cv::Mat1b(blocks, uchar{255}), cv::Mat1b(blocks, uchar{0}),
                    cv::Mat1b(blocks, uchar{0})};
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x)
      if (mask(y, x) != 0) out.mask(y / 2, x / 2) |= static_cast<uchar>(1 << (y % 2 * 2 + x % 2));
  for (int y = 0; y < blocks.height; ++y)
    for (int x = 0; x < blocks.width; ++x) {
      float far = 0, near = DepthMap::kSky, clear_px = 255;
      for (int v = std::max(0, 2 * y - 1); v <= std::min(full.height - 1, 2 * y + 2); ++v)
        for (int u = std::max(0, 2 * x - 1); u <= std::min(full.width - 1, 2 * x + 2); ++u) {
          const bool known = depth.z(v, u) != DepthMap::kUnknown;
          const float off = VisibilityMap::kMaxSigmas * depth.sigma(v, u);
          far = std::max(far, known ? depth.z(v, u) + off : DepthMap::kSky);
          near = std::min(near, known ? std::max(0.0F, depth.z(v, u) - off) : 0.0F);
          clear_px = std::min(clear_px, clearance(v, u));
        }
      out.clearance(y, x) = static_cast<uchar>(clear_px);
      if (far * VisibilityMap::kStepsPerMeter >= VisibilityMap::kNoSurface) continue;
      out.farthest(y, x) = static_cast<ushort>(std::ceil(far * VisibilityMap::kStepsPerMeter));
      const float spread = std::ceil((far / near - 1) * VisibilityMap::kSpreadSteps);
      out.spread(y, x) = static_cast<uchar>(std::min(spread, 255.0F));
    }
  return out;
}

}  // namespace dvi::depth
