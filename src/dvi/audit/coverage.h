#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/depth/depth.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/sample/sample.h"

namespace dvi::audit {

/// Parts of a hole, 0..1, by who else sees them.
struct HoleShares {
  double copied = 0;            ///< other frames of the same drive
  double copied_elsewhere = 0;  ///< source drives
  double unobserved = 0;
};

struct FrameForecast {
  std::size_t view = 0;
  double image_share = 0;  ///< of the image that is hole
  HoleShares hole;         ///< all zeros where there is no hole
};

/// What a run will be able to copy.
struct Forecast {
  std::vector<FrameForecast> frames;  ///< of the target drive
  HoleShares total;                   ///< over the pixels of all holes
};

/// Asks depth and sample for every `step`th row and column of the views only, so that neither colors nor whole depth maps are
/// needed. One tick a frame of the target drive.
Forecast forecast(
    const Views& views, const map::StaticMap& map, const depth::DepthOptions& depth, const sample::SampleOptions& sample,
    int step = 2, const Tick& tick = [] {});

/// The same views as cameras of every `step`th row and column. Images are left out.
Views every_nth(const Views& views, int step);

/// A bar a frame from left to right, as high as its hole is seen: this drive's part below, source drives' above it, what is
/// unobserved on top. Frames without a hole stay blank. `numbers` of the frames, for the axis.
cv::Mat3b forecast_chart(const Forecast& forecast, const std::vector<int>& numbers);

}  // namespace dvi::audit
