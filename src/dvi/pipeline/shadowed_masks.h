#pragma once

#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"

namespace dvi::pipeline {

/// A drive's masks with the shadows of what they hold (traffic/shadows.h), on demand; a frame without pose keeps its mask. The
/// same masks, and a note, where the drive has no poses or no scans to tell the ground by.
Lazy<cv::Mat1b> with_shadows(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                             Progress& progress);

}  // namespace dvi::pipeline
