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

/// A filled frame with the surfaces that are known of it.
struct ClassifiedFrame {
  harmonize::FilledFrame filled;
  cv::Mat1b classes;                 ///< The harmonize::SurfaceClass of the pixels of the hole; empty: all unknown.
  const ground::RoadGround& ground;  ///< That of the drive.
};

/// Determines the surface of each pixel of `where` in the frame of a view: ground, or upright surfaces and the sky. Without
/// ground, all pixels are upright.
SurfaceGuide guide_by_surfaces(const ClassifiedFrame& frame, const View& view, const cv::Mat1b& where);

}  // namespace dvi::synthesize
