#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/depth/depth.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/sample/sample.h"

namespace dvi::audit {

/// The shares of a hole, 0..1, by the sources that observe them.
struct HoleShares {
  double copied = 0;            ///< observed by other frames of the same drive
  double copied_elsewhere = 0;  ///< observed by source drives
  double unobserved = 0;
};

/// The coverage of the hole of one frame.
struct FrameCoverage {
  std::size_t view = 0;
  double image_share = 0;  ///< share of the image that is the hole
  HoleShares hole;         ///< all zero if there is no hole
};

/// The predicted coverage of the holes of a drive: the share that a run can copy.
struct Coverage {
  std::vector<FrameCoverage> frames;  ///< frames of the target drive
  HoleShares total;                   ///< over the pixels of all holes
};

/// The options of a prediction: those of its two stages, and every how many rows and columns are used.
struct CoverageOptions {
  depth::DepthOptions depth = {};
  sample::SampleOptions sample = {};
  int step = 2;
};

/// Predicts the coverage by running depth and sample on every `step`th row and column of the views, without colors and without
/// full depth maps. Calls `tick` once per frame of the target drive.
Coverage predict_coverage(const Views& views, const map::StaticMap& map, CoverageOptions options, const Tick& tick = [] {});

/// Returns the views with every `step`th row and column, without images.
Views subsample(const Views& views, int step);

/// Draws one bar per frame: the share of its hole that this drive observes, above it the share of source drives, and the
/// unobserved share on top. Frames without a hole have no bar. `numbers` are the frame numbers for the axis.
cv::Mat3b draw_coverage_chart(const Coverage& coverage, const std::vector<int>& numbers);

}  // namespace dvi::audit
