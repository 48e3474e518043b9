#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/exemplars.h"

namespace dvi::synthesize {

/// The groups of exemplars.
enum class Group : std::uint8_t { none, ground, upright };

/// Determines the surface of each pixel of `where` in a frame: ground, or upright surfaces and the sky. `classes` are the
/// harmonize::SurfaceClass of the pixels of the hole; empty: unknown. Without ground, all pixels are upright.
SurfaceGuide guide_by_surfaces(const harmonize::FilledFrame& frame, const View& view, const cv::Mat1b& classes,
                               const ground::RoadGround& ground, const cv::Mat1b& where);

}  // namespace dvi::synthesize
