#pragma once

#include <memory>

#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"
#include "dvi/traffic/ground.h"

namespace dvi::pipeline {

/// What to look for in the images round masks.
struct Compared {
  const FrameLabels* found = nullptr;  ///< where the masks are outlines of these, found in the scans: how the images end them
  bool shadows = true;                 ///< cast by what is masked
};

/// The ground of a drive, which its cameras share; none without poses or scans.
std::shared_ptr<const traffic::Ground> ground_of(const Drive& drive, const Trajectory& world_from_lidar);

/// A drive's masks after a comparison of each image with those of other times (traffic/silhouettes.h, traffic/shadows.h), on
/// demand; a frame without pose keeps its mask. The same masks, and a note, where the drive has no ground.
Lazy<cv::Mat1b> compared(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                         const Compared& what, const std::shared_ptr<const traffic::Ground>& ground, Progress& progress);

}  // namespace dvi::pipeline
