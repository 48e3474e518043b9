#include "dvi/synthesize/adapt_to_boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"
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

/// The mean color of the pixels of a mask over a square around each pixel of a box.
struct MaskedMean {
  MaskedMean(const cv::Mat3f& color, const cv::Mat1b& mask, const cv::Rect& pixels)
      : near(enlarge(pixels, kBoundary.side_px, mask.size())) {
    cv::Mat3f masked(near.size(), cv::Vec3f());
    color(near).copyTo(masked, mask(near));
    const cv::Size side(kBoundary.side_px, kBoundary.side_px);
    cv::boxFilter(masked, mean, CV_32F, side);
    cv::Mat1f ones(near.size(), 0.0F);
    ones.setTo(1, mask(near));
    cv::boxFilter(ones, share, CV_32F, side);
  }
  cv::Vec3f at(cv::Point p) const { return mean(p - near.tl()) / share(p - near.tl()); }
  bool has(cv::Point p) const { return share(p - near.tl()) > 1e-3F; }

  cv::Rect near;  ///< The part of the image that the matrices below cover.
  cv::Mat3f mean;
  cv::Mat1f share;
};

/// Steps of the mean color across the boundary, from inside to outside, and their weights.
struct BoundarySteps {
  explicit BoundarySteps(cv::Size size) : step(size, cv::Vec3f()), weight(size, 0.0F) {}

  /// Adds those at the inner pixels of a group.
  void add(const cv::Mat3f& color, const cv::Mat1b& inner, const cv::Mat1b& group) {
    const cv::Mat1b inner_group(inner & group);
    const cv::Rect box = cv::boundingRect(inner_group);
    if (box.empty()) return;
    const MaskedMean inside(color, inner_group, box), outside(color, cv::Mat1b(~inner & group), box);
    for (const cv::Point p : Region(inner_group).pixels) {
      if (!inside.has(p) || !outside.has(p)) continue;
      const cv::Vec3f difference = outside.at(p) - inside.at(p);
      const float size = static_cast<float>(cv::norm(difference)) / kBoundary.edge_levels;
      step(p) = cv::Vec3f::all((difference[0] + difference[1] + difference[2]) / 3);
      weight(p) = std::exp(-size * size);
    }
  }

  cv::Mat3f step;
  cv::Mat1f weight;
};

}  // namespace

void adapt_to_boundary(cv::Mat3f& color, const cv::Mat1b& inner, const SurfaceGuide& guide) {
  const Region region(inner);
  if (region.pixels.empty()) return;
  BoundarySteps steps(color.size());
  for (const Group group : {Group::ground, Group::upright})
    steps.add(color, inner, cv::Mat1b(guide.group == static_cast<uchar>(group)));
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
        diagonal += steps.weight(p);
        right += steps.weight(p) * steps.step(p);
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
