#pragma once

#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"

namespace dvi::pipeline {

/// What to look for in the images round masks.
struct Compared {
  const FrameLabels* found = nullptr;  ///< where the masks are outlines of these, found in the scans: how the images end them
  bool shadows = true;                 ///< cast by what is masked
};

/// A drive's masks after a comparison of each image with those of other times (traffic/silhouettes.h, traffic/shadows.h), on
/// demand; a frame without pose keeps its mask. The same masks, and a note, where the drive has no poses or no scans to tell
/// the ground by.
Lazy<cv::Mat1b> compared(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                         const Compared& what, Progress& progress);

}  // namespace dvi::pipeline
