#include "dvi/synthesize/adapt_to_boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

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

/// The mean color of the pixels of a mask over a square around each pixel.
struct MaskedMean {
  MaskedMean(const cv::Mat3f& color, const cv::Mat1b& mask) {
    cv::Mat3f masked(color.size(), cv::Vec3f());
    color.copyTo(masked, mask);
    const cv::Size side(kBoundary.side_px, kBoundary.side_px);
    cv::boxFilter(masked, mean, CV_32F, side);
    cv::Mat1f ones(mask.size(), 0.0F);
    ones.setTo(1, mask);
    cv::boxFilter(ones, share, CV_32F, side);
  }
  cv::Vec3f at(cv::Point p) const { return mean(p) / share(p); }
  bool has(cv::Point p) const { return share(p) > 1e-3F; }

  cv::Mat3f mean;
  cv::Mat1f share;
};

/// Adds, for the inner pixels of a group, the difference of the mean colors outside and inside, and its weight.
void add_steps(const cv::Mat3f& color, const cv::Mat1b& inner, const cv::Mat1b& group, cv::Mat3f& step, cv::Mat1f& weight) {
  const MaskedMean inside(color, cv::Mat1b(inner & group)), outside(color, cv::Mat1b(~inner & group));
  for (const cv::Point p : Region(cv::Mat1b(inner & group)).pixels) {
    if (!inside.has(p) || !outside.has(p)) continue;
    const cv::Vec3f difference = outside.at(p) - inside.at(p);
    const float size = static_cast<float>(cv::norm(difference)) / kBoundary.edge_levels;
    step(p) = cv::Vec3f::all((difference[0] + difference[1] + difference[2]) / 3);
    weight(p) = std::exp(-size * size);
  }
}

}  // namespace

void adapt_to_boundary(cv::Mat3f& color, const cv::Mat1b& inner, const SurfaceGuide& guide) {
  const Region region(inner);
  if (region.pixels.empty()) return;
  cv::Mat3f step(color.size(), cv::Vec3f());  // across the boundary, from inside to outside, of mean colors
  cv::Mat1f weight(color.size(), 0.0F);
  for (const Group group : {Group::ground, Group::upright})
    add_steps(color, inner, cv::Mat1b(guide.group == static_cast<uchar>(group)), step, weight);
  const cv::Rect inside({}, inner.size());
  PoissonSystem system{region, {}, {}, 1};
  for (const cv::Point p : region.pixels) {
    float diagonal = kBoundary.screening;
    cv::Vec3f right;
    for (const cv::Point q : four_neighbors(p)) {
      if (!inside.contains(q)) continue;
      if (inner(q) != 0) {
        diagonal += 1;
      } else if (guide.group(p) == guide.group(q)) {
        diagonal += weight(p);
        right += weight(p) * step(p);
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
