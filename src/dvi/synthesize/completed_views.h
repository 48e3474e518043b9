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

/// Selects the views to complete: views of the target at intervals of some meters or degrees, and the views at both ends. Each
/// view is completed after those before it, which it shows, too. The first is the view nearest to the surfaces that others show
/// from farther away: the last one, or the first one of a drive backward.
std::vector<std::size_t> select_views_to_complete(const Views& views);

/// Makes a completed view from the pixels of `completed`, 255 each, of a frame. Ground has the depth of the road's ground;
/// upright surfaces have the depth of the frame, or that of the ground at their feet.
CompletedView make_completed_view(const harmonize::FilledFrame& frame, const cv::Mat1b& completed, const SurfaceGuide& guide,
                                  const Views& views, std::size_t view, const ground::RoadGround& ground);

/// Writes the colors of completed views into the pixels of `wanted` of a view, and returns the pixels that a completed view
/// shows, 255 each. Of several, the first one counts.
cv::Mat1b show_completed_views(const CompletedViews& all, const Views& views, const View& view, const cv::Mat1b& wanted,
                               cv::Mat3f& color);

}  // namespace dvi::synthesize
