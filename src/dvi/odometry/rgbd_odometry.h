#pragma once

#include "dvi/odometry/odometry.h"

namespace dvi::odometry {

/// Whether the drive is a recording of a depth camera with color images, which rgbd_odometry() needs.
bool has_color_and_depth(const Drive& drive);

/// Poses of a depth camera from color and depth together. Each image is aligned directly to a key frame (direct_alignment.h),
/// starting from the motion so far, from no motion, from the rotation that the thumbnails show, and from the given motion;
/// the start that fits best wins. What cannot be aligned reliably has no pose: these scans are `lost`, and the trajectory has
/// breaks there. A lost track is recovered against all key frames; if that fails for some time, a new map begins, which joins
/// an earlier one as soon as both see the same place. Scans of maps that do not join the largest one are lost, too. When the
/// camera returns to an earlier view, key frames are aligned to each other, and a pose graph of the key frames distributes the
/// drift. `options.loops` switches this off.
Odometry rgbd_odometry(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const BeginPart& begin);

}  // namespace dvi::odometry
