#include "dvi/eval/tally.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "dvi/eval/evaluation.h"
#include "dvi/eval/metrics.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi {
namespace {

constexpr float kSteps = 256;
constexpr std::size_t kBins = 64 * 256 + 1;

cv::Mat1b pixels_of(const ScoredFrame& frame, Origin origin) {
  const auto between = [&](Kind first, Kind last) {
    cv::Mat1b pixels;
    cv::inRange(frame.kind, static_cast<int>(first), static_cast<int>(last), pixels);
    cv::bitwise_and(pixels, frame.scored, pixels);
    return pixels;
  };
  switch (origin) {
    case Origin::all:
      return frame.scored;
    case Origin::copied:
      return between(Kind::copied, Kind::copied_elsewhere);
    case Origin::interpolated:
      return between(Kind::interpolated, Kind::interpolated);
    case Origin::synthesised:
      return between(Kind::synthesised, Kind::synthesised);
    case Origin::empty:
      return between(Kind::empty, Kind::empty);
  }
  throw std::logic_error("no such origin");
}

/// The per pixel figures of a frame, whatever the origin.
struct Maps {
  Maps(const ScoredFrame& frame, const ScoredFrame* before)
      : ssim(ssim_map(frame.result, frame.truth)),
        gradient_result(gradient_magnitude(frame.result)),
        gradient_truth(gradient_magnitude(frame.truth)) {
    if (!before) return;
    const cv::Mat2f motion = optical_flow(frame.clean, before->clean);
    change_result = change_along(frame.result, before->result, motion, frame.scored);
    change_truth = change_along(frame.clean, before->clean, motion, frame.scored);
  }
  cv::Mat1f ssim, gradient_result, gradient_truth, change_result, change_truth;
};

OriginSums sums(const ScoredFrame& frame, const Maps& maps, const cv::Mat1b& pixels) {
  OriginSums out;
  out.pixels = static_cast<std::size_t>(cv::countNonZero(pixels));
  if (out.pixels == 0) return out;
  out.frames = 1;
  out.error = error_sums(frame.result, frame.truth, pixels);
  out.frame_psnr = out.error.psnr();
  out.frame_ssim = sum_over(maps.ssim, pixels).mean();
  out.gradient_result = sum_over(maps.gradient_result, pixels);
  out.gradient_truth = sum_over(maps.gradient_truth, pixels);
  if (!maps.change_result.empty()) {
    out.change_result = sum_over(maps.change_result, pixels);
    out.change_truth = sum_over(maps.change_truth, pixels);
  }
  return out;
}

Lengths misplaced(const ScoredFrame& frame, const cv::Mat1b& copied) {
  Lengths lengths;
  if (cv::countNonZero(copied) == 0) return lengths;
  const cv::Mat1f map = misplacement(frame.result, frame.clean, frame.scored);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      if (copied(y, x)) lengths.add(map(y, x));
  return lengths;
}

double ratio(const PixelSum& result, const PixelSum& truth) { return truth.sum > 0 ? result.sum / truth.sum : Figures::kNone; }

}  // namespace

void Lengths::add(float length_px) {
  bins_.resize(kBins);
  ++bins_[std::min(kBins - 1, static_cast<std::size_t>(std::min(length_px, 64.0F) * kSteps + 0.5F))];
  ++count_;
}

Lengths& Lengths::operator+=(const Lengths& other) {
  if (other.count_ == 0) return *this;
  bins_.resize(kBins);
  for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  return *this;
}

double Lengths::median() const {
  if (count_ == 0) return Figures::kNone;
  std::uint64_t below = 0;
  std::size_t bin = 0;
  while (2 * (below + bins_[bin]) < count_) below += bins_[bin++];
  return static_cast<double>(bin) / double{kSteps};
}

OriginSums& OriginSums::operator+=(const OriginSums& other) {
  frames += other.frames;
  pixels += other.pixels;
  error += other.error;
  frame_psnr += other.frame_psnr;
  frame_ssim += other.frame_ssim;
  gradient_result += other.gradient_result;
  gradient_truth += other.gradient_truth;
  change_result += other.change_result;
  change_truth += other.change_truth;
  return *this;
}

Tally& Tally::operator+=(const Tally& other) {
  for (std::size_t i = 0; i < origins.size(); ++i) origins[i] += other.origins[i];
  misplaced += other.misplaced;
  return *this;
}

ByOrigin Tally::figures() const {
  ByOrigin out;
  for (const Origin origin : kOrigins) {
    const OriginSums& s = origins[static_cast<std::size_t>(origin)];
    if (s.pixels == 0) continue;
    Figures& f = out[origin];
    f.frames = s.frames;
    f.pixels = s.pixels;
    f.share = static_cast<double>(s.pixels) / static_cast<double>(pixels(Origin::all));
    f.mae = s.error.mae();
    f.rmse = s.error.rmse();
    f.psnr = s.frame_psnr / static_cast<double>(s.frames);
    f.ssim = s.frame_ssim / static_cast<double>(s.frames);
    f.sharpness = ratio(s.gradient_result, s.gradient_truth);
    f.flicker = ratio(s.change_result, s.change_truth);
  }
  out[Origin::all].misplaced_px = out[Origin::copied].misplaced_px = misplaced.median();
  return out;
}

Tally tally(const ScoredFrame& frame, const ScoredFrame* before) {
  Tally out;
  if (cv::countNonZero(frame.scored) == 0) return out;
  const Maps maps(frame, before);
  for (const Origin origin : kOrigins)
    out.origins[static_cast<std::size_t>(origin)] = sums(frame, maps, pixels_of(frame, origin));
  out.misplaced = misplaced(frame, pixels_of(frame, Origin::copied));
  return out;
}

}  // namespace dvi
