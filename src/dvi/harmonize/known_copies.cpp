#include "dvi/harmonize/known_copies.h"

#include <cstdlib>
#include <memory>

#include <opencv2/imgproc.hpp>

#include "dvi/harmonize/illumination_change.h"

namespace dvi::harmonize {
namespace {

constexpr float kMaxErrorLevels = 10;  // the threshold in the definition of confidence
constexpr int kMeanWindowPx = 35;      // the window in which the change of illumination is averaged

/// Replaces each value by the sum of the values in the window around it.
void sum_in_windows(cv::Mat& values) { cv::boxFilter(values, values, -1, {kMeanWindowPx, kMeanWindowPx}, {-1, -1}, false); }

}  // namespace

CopyEvidence gather_evidence(const depth::Target& target, const Fused& fused, std::size_t pixel, const CopyTarget& to) {
  const sample::Candidate& source = fused.candidates.leading[pixel];
  const View& from = target.views[source.view];
  return {.position_error_px = source.position_error_px,
          .texture = to.texture,
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
  const std::shared_ptr<const cv::Mat3b> image = target.image();
  const auto difference_of = [&](std::size_t i) { return cv::Vec3f((*image)(known.hole.pixels[i])) - fused.color[i]; };
  cv::Mat3f sums(image->size(), cv::Vec3f());
  cv::Mat1f counts(image->size(), 0.0F);
  const std::vector<cv::Point>& pixels = known.hole.pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!fused.candidates.leading[i].found()) continue;
    sums(pixels[i]) = difference_of(i);
    counts(pixels[i]) = 1;
  }
  sum_in_windows(sums);
  sum_in_windows(counts);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!fused.candidates.leading[i].found()) continue;
    const cv::Vec3f changed = sums(pixels[i]) / counts(pixels[i]);
    const bool is_within = max_difference(difference_of(i), changed) <= kMaxErrorLevels;
    const CopyTarget to{measure_texture(*image, pixels[i]), mean_difference(changed, {})};
    out.push_back({estimate_error_levels(gather_evidence(target, fused, i, to)), is_within});
  }
  return out;
}

}  // namespace dvi::harmonize
