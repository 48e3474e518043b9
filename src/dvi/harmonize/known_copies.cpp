#include "dvi/harmonize/known_copies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "dvi/harmonize/day_light.h"

namespace dvi::harmonize {
namespace {

constexpr float kWithin = 10;  // gray levels, as confidence is defined

double texture(const cv::Mat3f& image, cv::Point p) {
  float most = 0;
  for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)})
    if (cv::Rect({}, image.size()).contains(q)) most = std::max(most, mean_difference(image(p), image(q)));
  return most;
}

/// The mean nearby of what is known at some pixels.
cv::Mat3f mean_nearby(cv::Mat3f sums, cv::Mat1f weights) {
  constexpr int kNear = 35;  // px
  cv::boxFilter(sums, sums, -1, {kNear, kNear}, {-1, -1}, false);
  cv::boxFilter(weights, weights, -1, {kNear, kNear}, {-1, -1}, false);
  cv::Mat3f out(sums.size(), cv::Vec3f());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      if (weights(y, x) > 0.5F) out(y, x) = sums(y, x) / weights(y, x);
  return out;
}

}  // namespace

CopyEvidence evidence_of(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopiedTo& to) {
  const sample::Candidate& source = fused.candidates.leading[pixel];
  const View& from = target.views[source.view];
  return {.shift = source.position_error_px,
          .texture = texture(to.image, fused.candidates.hole.pixels[pixel]),
          .spread = fused.spread[pixel],
          .alone = fused.sources[pixel] == 1 && fused.spread[pixel] == 0,
          .elsewhere = from.drive != target.view().drive,
          .change = to.change,
          .seconds = 1e-9 * static_cast<double>(std::llabs(from.time_ns - target.view().time_ns))};
}

std::vector<KnownCopy> known_copies(const depth::Target& target, const sample::Candidates& known) {
  std::vector<KnownCopy> out;
  if (known.hole.size() == 0) return out;
  const Fused fused = fuse(target, known, DayLight{});
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
  const cv::Mat3f light = mean_nearby(off.clone(), copied.clone());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (copied(pixels[i]) == 0) continue;
    const cv::Vec3f& changed = light(pixels[i]);
    const bool within = most_different(off(pixels[i]), changed) <= kWithin;
    out.push_back({expected_error(evidence_of(target, fused, i, {image, mean_difference(changed, {})})), within});
  }
  return out;
}

}  // namespace dvi::harmonize
