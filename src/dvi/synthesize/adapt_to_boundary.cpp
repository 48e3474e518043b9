#include "dvi/synthesize/adapt_to_boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/surface_guide.h"

namespace dvi::synthesize {
namespace {

/// Parameters of the adaptation to the boundary.
struct BoundaryParams {
  float screening = 2e-3F;  ///< Weight of the change 0 of a pixel: the boundary has an effect on 1 / sqrt(weight) pixels.
  int side_px = 15;         ///< Side of the squares whose mean colors are compared.
  float edge_levels = 30;   ///< Difference of these colors above which both are different things, and nothing is adapted.
};
constexpr BoundaryParams kBoundary;

/// A step of the mean color across the boundary, from inside to outside, and its weight.
struct BoundaryStep {
  cv::Vec3f step;
  float weight = 0;
};

/// The mean color of some pixels of the square.
struct MeanColor {
  static constexpr double kPixelShare = 1.0 / (kBoundary.side_px * kBoundary.side_px);
  cv::Vec3d sum;
  int count = 0;

  void add(const cv::Vec3f& color) {
    sum += cv::Vec3d(color);
    ++count;
  }
  cv::Vec3f get() const { return cv::Vec3f(sum * kPixelShare) / static_cast<float>(count * kPixelShare); }
};

/// Compares the mean colors of the inner and of the outer pixels in the square around a pixel, which have its group.
BoundaryStep measure_step(const cv::Mat3f& color, const cv::Mat1b& inner, const cv::Mat1b& group, cv::Point p) {
  constexpr int kHalf = kBoundary.side_px / 2;
  MeanColor inside, outside;
  for (int y = p.y - kHalf; y <= p.y + kHalf; ++y)
    for (int x = p.x - kHalf; x <= p.x + kHalf; ++x) {
      const cv::Point q(cv::borderInterpolate(x, color.cols, cv::BORDER_REFLECT_101),
                        cv::borderInterpolate(y, color.rows, cv::BORDER_REFLECT_101));
      if (group(q) == group(p)) (inner(q) != 0 ? inside : outside).add(color(q));
    }
  if (inside.count == 0 || outside.count == 0) return {};
  const cv::Vec3f difference = outside.get() - inside.get();
  const float size = static_cast<float>(cv::norm(difference)) / kBoundary.edge_levels;
  return {cv::Vec3f::all((difference[0] + difference[1] + difference[2]) / 3), std::exp(-size * size)};
}

}  // namespace

void adapt_to_boundary(cv::Mat3f& color, const cv::Mat1b& inner, const SurfaceGuide& guide) {
  const Region region(inner);
  if (region.pixels.empty()) return;
  const cv::Rect inside({}, inner.size());
  PoissonSystem system{region, {}, {}, 1};
  for (const cv::Point p : region.pixels) {
    float diagonal = kBoundary.screening;
    cv::Vec3f right;
    std::optional<BoundaryStep> step;
    for (const cv::Point q : four_neighbors(p)) {
      if (!inside.contains(q)) continue;
      if (inner(q) != 0) {
        diagonal += 1;
      } else if (guide.group(p) != static_cast<uchar>(Group::none) && guide.group(p) == guide.group(q)) {
        if (!step) step = measure_step(color, inner, guide.group, p);
        diagonal += step->weight;
        right += step->weight * step->step;
      }
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(right);
  }
  std::vector<cv::Vec3f> offsets(region.size());
  solve_poisson(system, offsets);
  for (std::size_t i = 0; i < offsets.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      float& value = color(region.pixels[i])[c];
      value = std::clamp(value + offsets[i][c], 0.0F, 255.0F);
    }
}

}  // namespace dvi::synthesize
