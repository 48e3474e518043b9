#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/metrics/calibration.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/metrics.h"

namespace dvi::metrics {

/// A histogram of lengths in steps of 1/256 px up to 64 px, for medians with constant memory.
class LengthHistogram {
 public:
  void add(float length_px);
  LengthHistogram& operator+=(const LengthHistogram& other);
  double median() const;  ///< NaN if there are none

 private:
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
};

/// The sums for the figures of one origin, over one frame or several.
struct OriginSums {
  std::size_t frames = 0, pixels = 0;
  ErrorSums error;
  double frame_psnr = 0, frame_ssim = 0;  ///< sums over frames
  PixelSum gradient_result, gradient_truth;
  PixelSum change_result, change_truth;

  OriginSums& operator+=(const OriginSums& other);
};

/// Computes the figures of the sums, except share and position error.
Figures compute_figures(const OriginSums& sums);

/// The sums over one frame or several, by origin.
struct Tally {
  std::array<OriginSums, kOrigins.size()> origins;
  OriginSums whole_frame;  ///< without gradients and changes
  LengthHistogram position_errors;
  std::array<ConfidenceCounts, kOrigins.size()> confidence;

  Tally& operator+=(const Tally& other);
  ByOrigin compute_figures() const;
  std::size_t pixels(Origin origin) const { return origins[static_cast<std::size_t>(origin)].pixels; }
};

/// A frame with its masks for scoring.
struct ScoredFrame {
  cv::Mat3b result;
  cv::Mat3b truth;  ///< as given; empty if nothing is scored
  cv::Mat3b clean;  ///< the truth inside the masks and the input outside: a complete true frame
  cv::Mat1b scored, kind;
  cv::Mat1b confidence;  ///< empty if there is none
};

/// Computes the sums of a frame. `before` is the frame before, or null.
Tally make_tally(const ScoredFrame& frame, const ScoredFrame* before);

}  // namespace dvi::metrics
