#pragma once

#include "dvi/odometry/odometry.h"

namespace dvi::odometry {

/// Returns whether the drive is a recording of a depth camera with color images, which rgbd_odometry() requires.
bool has_color_and_depth(const Drive& drive);

/// Estimates the poses of a depth camera from color and depth together. Each image is aligned directly to a key frame
/// (direct_alignment.h), with four initial guesses: constant velocity, no motion, the rotation that the thumbnails show, and
/// the given motion; the best fit is kept. Images that cannot be aligned reliably have no pose: these scans are `lost`, and the
/// trajectory has gaps there. After a loss, images are aligned to all key frames; if that fails for some time, a new map
/// begins, which joins an earlier map as soon as both show the same place. Scans of maps that do not join the largest one are
/// lost, too. When the camera returns to an earlier view, key frames are aligned to each other, and a pose graph of the key
/// frames distributes the drift. `options.loops` switches this off.
Odometry rgbd_odometry(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const BeginPart& begin);

}  // namespace dvi::odometry
