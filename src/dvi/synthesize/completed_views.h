#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/surface_guide.h"

namespace dvi::synthesize {

/// A frame whose unobserved pixels are synthesized.
struct SynthesizedFrame {
  harmonize::FilledFrame frame;
  cv::Mat1b completed;  ///< 255: the pixel is not shown by any completed view and was completed in this frame.
  SurfaceGuide guide;   ///< The groups of its pixels; empty if no pixel is unobserved.
};

/// The unobserved pixels of a view that were completed there, with depths. Other frames show them from their own positions.
struct CompletedView {
  std::size_t view = 0;
  std::vector<std::int32_t> pixels;  ///< Index of each pixel, row by row, ascending.
  std::vector<cv::Vec3b> colors;     ///< BGR, in the illumination of the view.
  std::vector<float> depths_m;       ///< Depth z of each pixel.

  std::size_t size() const { return pixels.size(); }
};

/// The completed views of a drive, in the order in which they are completed.
using CompletedViews = std::vector<CompletedView>;

/// Selects the views to complete: targets of each camera at intervals of some meters or degrees, and those at both ends. Each
/// view is completed after those before it, which it shows, too. The first is the view nearest to the surfaces that others show
/// from farther away: the last one, or the first one of a drive backward.
std::vector<std::size_t> select_views_to_complete(const Views& views);

/// Makes a completed view from the pixels that were completed in a frame. Ground has the depth of the road's ground; upright
/// surfaces have the depth of the frame, or that of the ground at their feet.
CompletedView make_completed_view(const SynthesizedFrame& made, const Views& views, std::size_t view,
                                  const ground::RoadGround& ground);

/// The pixels of a view that completed views show.
struct ShownPixels {
  cv::Mat1b shown;  ///< 255 each.
  cv::Mat3f color;  ///< In the illumination of the view; 0 elsewhere.
};

/// Shows completed views in the pixels of `wanted` of a view. Of several, the first one counts.
ShownPixels show_completed_views(const CompletedViews& all, const Views& views, const View& view, const cv::Mat1b& wanted);

}  // namespace dvi::synthesize
