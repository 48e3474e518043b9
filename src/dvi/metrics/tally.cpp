#include "dvi/metrics/tally.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/metrics/calibration.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/metrics.h"

namespace dvi::metrics {
namespace {

constexpr float kStepsPerPx = 256;
constexpr std::size_t kBins = 64 * 256 + 1;

cv::Mat1b select_pixels(const ScoredFrame& frame, Origin origin) {
  const auto between = [&](harmonize::Kind first, harmonize::Kind last) {
    cv::Mat1b pixels;
    cv::inRange(frame.kind, static_cast<int>(first), static_cast<int>(last), pixels);
    cv::bitwise_and(pixels, frame.scored, pixels);
    return pixels;
  };
  switch (origin) {
    case Origin::all:
      return frame.scored;
    case Origin::copied:
      return between(harmonize::Kind::copied, harmonize::Kind::copied_elsewhere);
    case Origin::interpolated:
      return between(harmonize::Kind::interpolated, harmonize::Kind::interpolated);
    case Origin::synthesized:
      return between(harmonize::Kind::synthesized, harmonize::Kind::synthesized);
    case Origin::empty:
      return between(harmonize::Kind::empty, harmonize::Kind::empty);
    case Origin::imported:
      return between(harmonize::Kind::imported, harmonize::Kind::imported);
  }
  throw std::logic_error("no such origin");
}

/// The figures per pixel of a frame.
struct Maps {
  Maps(const ScoredFrame& frame, const ScoredFrame* before)
      : ssim(compute_ssim(frame.result, frame.truth)),
        gradient_result(compute_gradient(frame.result)),
        gradient_truth(compute_gradient(frame.truth)) {
    if (!before) return;
    const cv::Mat2f motion = compute_optical_flow(gray_8bit(frame.clean), gray_8bit(before->clean));
    change_result = compute_change(frame.result, before->result, motion, frame.scored);
    change_truth = compute_change(frame.clean, before->clean, motion, frame.scored);
  }
  cv::Mat1f ssim, gradient_result, gradient_truth, change_result, change_truth;
};

OriginSums make_sums(const ScoredFrame& frame, const Maps& maps, const cv::Mat1b& pixels) {
  OriginSums out;
  out.pixels = static_cast<std::size_t>(cv::countNonZero(pixels));
  if (out.pixels == 0) return out;
  out.frames = 1;
  out.error = sum_errors(frame.result, frame.truth, pixels);
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

OriginSums make_whole_frame_sums(const ScoredFrame& frame, const ErrorSums& scored) {
  cv::Mat3b truth = frame.result.clone();
  frame.truth.copyTo(truth, frame.scored);
  const cv::Mat1b everywhere(truth.size(), uchar{255});
  OriginSums out;
  out.frames = 1;
  out.pixels = truth.total();
  out.error = scored;
  out.error.values = 3 * out.pixels;
  out.frame_psnr = out.error.psnr();
  out.frame_ssim = sum_over(compute_ssim(frame.result, truth), everywhere).mean();
  return out;
}

LengthHistogram measure_position_errors(const ScoredFrame& frame, const cv::Mat1b& copied) {
  LengthHistogram lengths;
  if (cv::countNonZero(copied) == 0) return lengths;
  const cv::Mat1f map = compute_position_error(frame.result, frame.clean, frame.scored);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      if (copied(y, x)) lengths.add(map(y, x));
  return lengths;
}

double compute_ratio(const PixelSum& result, const PixelSum& truth) {
  return truth.sum > 0 ? result.sum / truth.sum : Figures::kNone;
}

}  // namespace

void LengthHistogram::add(float length_px) {
  bins_.resize(kBins);
  ++bins_[std::min(kBins - 1, static_cast<std::size_t>(std::min(length_px, 64.0F) * kStepsPerPx + 0.5F))];
  ++count_;
}

LengthHistogram& LengthHistogram::operator+=(const LengthHistogram& other) {
  if (other.count_ == 0) return *this;
  bins_.resize(kBins);
  for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
  return *this;
}

double LengthHistogram::median() const {
  if (count_ == 0) return Figures::kNone;
  std::uint64_t below = 0;
  std::size_t bin = 0;
  while (2 * (below + bins_[bin]) < count_) below += bins_[bin++];
  return static_cast<double>(bin) / double{kStepsPerPx};
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
  for (std::size_t i = 0; i < origins.size(); ++i) {
    origins[i] += other.origins[i];
    confidence[i] += other.confidence[i];
  }
  whole_frame += other.whole_frame;
  position_errors += other.position_errors;
  return *this;
}

Figures compute_figures(const OriginSums& sums) {
  Figures out;
  if (sums.pixels == 0) return out;
  out.frames = sums.frames;
  out.pixels = sums.pixels;
  out.mae = sums.error.mae();
  out.rmse = sums.error.rmse();
  out.psnr = sums.frame_psnr / static_cast<double>(sums.frames);
  out.ssim = sums.frame_ssim / static_cast<double>(sums.frames);
  out.sharpness = compute_ratio(sums.gradient_result, sums.gradient_truth);
  out.flicker = compute_ratio(sums.change_result, sums.change_truth);
  return out;
}

ByOrigin Tally::compute_figures() const {
  ByOrigin out;
  for (const Origin origin : kOrigins) {
    const OriginSums& sums = origins[static_cast<std::size_t>(origin)];
    out[origin] = dvi::metrics::compute_figures(sums);
    if (sums.pixels > 0) out[origin].share = static_cast<double>(sums.pixels) / static_cast<double>(pixels(Origin::all));
  }
  out[Origin::all].position_error_px = out[Origin::copied].position_error_px = position_errors.median();
  return out;
}

Tally make_tally(const ScoredFrame& frame, const ScoredFrame* before) {
  Tally out;
  if (cv::countNonZero(frame.scored) == 0) return out;
  const Maps maps(frame, before);
  for (const Origin origin : kOrigins) {
    const auto i = static_cast<std::size_t>(origin);
    const cv::Mat1b pixels = select_pixels(frame, origin);
    out.origins[i] = make_sums(frame, maps, pixels);
    if (!frame.confidence.empty()) out.confidence[i] = count_confidence(frame.confidence, frame.result, frame.truth, pixels);
  }
  out.whole_frame = make_whole_frame_sums(frame, out.origins[static_cast<std::size_t>(Origin::all)].error);
  out.position_errors = measure_position_errors(frame, select_pixels(frame, Origin::copied));
  return out;
}

}  // namespace dvi::metrics
