#include "dvi/harmonize/known_copies.h"

#include <algorithm>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "dvi/harmonize/illumination_change.h"
#include "dvi/image/neighbors.h"

namespace dvi::harmonize {
namespace {

constexpr float kMaxErrorLevels = 10;  // the threshold in the definition of confidence
constexpr int kMeanWindowPx = 35;      // the window in which the change of illumination is averaged

/// Computes the largest difference of a pixel to a neighbor.
double measure_texture(const cv::Mat3f& image, cv::Point p) {
  float texture = 0;
  for (const cv::Point q : four_neighbors(p))
    if (cv::Rect({}, image.size()).contains(q)) texture = std::max(texture, mean_difference(image(p), image(q)));
  return texture;
}

/// Computes the local mean of values that are known at some pixels; zeros where none is near.
cv::Mat3f compute_local_mean(cv::Mat3f sums, cv::Mat1f weights) {
  cv::boxFilter(sums, sums, -1, {kMeanWindowPx, kMeanWindowPx}, {-1, -1}, false);
  cv::boxFilter(weights, weights, -1, {kMeanWindowPx, kMeanWindowPx}, {-1, -1}, false);
  cv::Mat3f out(sums.size(), cv::Vec3f());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (weights(y, x) > 0.5F) out(y, x) = sums(y, x) / weights(y, x);
  return out;
}

}  // namespace

CopyEvidence gather_evidence(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopyTarget& to) {
  const sample::Candidate& source = fused.candidates.leading[pixel];
  const View& from = target.views[source.view];
  return {.position_error_px = source.position_error_px,
          .texture = measure_texture(to.image, fused.candidates.hole.pixels[pixel]),
          .spread = fused.spread[pixel],
          .is_single = fused.sources[pixel] == 1 && fused.spread[pixel] == 0,
          .is_other_drive = from.drive != target.view().drive,
          .change = to.change,
          .seconds = 1e-9 * static_cast<double>(std::llabs(from.time_ns - target.view().time_ns))};
}

std::vector<KnownCopy> measure_known_copies(const depth::Target& target, const sample::Candidates& known) {
  std::vector<KnownCopy> out;
  if (known.hole.size() == 0) return out;
  const Fused fused = fuse(target, known, IlluminationChange{});
  cv::Mat3f image;
  target.image()->convertTo(image, CV_32FC3);
  cv::Mat3f off(image.size(), cv::Vec3f());
  cv::Mat1f copied(image.size(), 0.0F);
  const std::vector<cv::Point>& pixels = known.hole.pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!fused.candidates.leading[i].found()) continue;
    off(pixels[i]) = image(pixels[i]) - fused.color[i];
    copied(pixels[i]) = 1;
  }
  const cv::Mat3f illumination = compute_local_mean(off.clone(), copied.clone());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (copied(pixels[i]) == 0) continue;
    const cv::Vec3f& changed = illumination(pixels[i]);
    const bool is_within = max_difference(off(pixels[i]), changed) <= kMaxErrorLevels;
    out.push_back({estimate_error_levels(gather_evidence(target, fused, i, {image, mean_difference(changed, {})})), is_within});
  }
  return out;
}

}  // namespace dvi::harmonize
