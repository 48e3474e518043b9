#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/metrics/calibration.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/metrics.h"

namespace dvi::metrics {

/// Lengths counted in steps of 1/256 px up to 64 px: a median of any number of them in the same memory.
class Lengths {
 public:
  void add(float length_px);
  Lengths& operator+=(const Lengths& other);
  double median() const;  ///< NaN of none

 private:
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
};

/// What the figures of one origin are made of, for one frame or, added up, for many.
struct OriginSums {
  std::size_t frames = 0, pixels = 0;
  ErrorSums error;
  double frame_psnr = 0, frame_ssim = 0;  ///< sums over frames
  PixelSum gradient_result, gradient_truth;
  PixelSum change_result, change_truth;

  OriginSums& operator+=(const OriginSums& other);
};

/// What they amount to; share and misplaced_px are not known here.
Figures figures(const OriginSums& sums);

struct Tally {
  std::array<OriginSums, kOrigins.size()> origins;
  OriginSums whole_frame;  ///< without gradients and changes
  Lengths misplaced;
  std::array<ConfidenceCounts, kOrigins.size()> confidence;

  Tally& operator+=(const Tally& other);
  ByOrigin figures() const;
  std::size_t pixels(Origin origin) const { return origins[static_cast<std::size_t>(origin)].pixels; }
};

/// A frame as it is scored.
struct ScoredFrame {
  cv::Mat3b result;
  cv::Mat3b truth;  ///< as given; empty where nothing is scored
  cv::Mat3b clean;  ///< the truth inside the mask, the result, which is the input, outside: a whole picture
  cv::Mat1b scored, kind;
  cv::Mat1b confidence;  ///< empty where none is given
};

/// `before` is the frame before this one, or null.
Tally tally(const ScoredFrame& frame, const ScoredFrame* before);

}  // namespace dvi::metrics
