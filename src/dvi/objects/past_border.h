#pragma once

#include "dvi/drive/drive.h"
#include "dvi/objects/label_masks.h"

namespace dvi::objects {

/// Extends labeled tracks beyond the image border. Labels often end while a part of the object is still visible. If the first
/// or last box of a track touches the border, the box continues with its last motion, in world axes or, without poses, in LiDAR
/// axes, for at most a second and only while it is inside the image. `labels` are per frame of the drive.
FrameLabels extend_past_border(const Drive& drive, FrameLabels labels, const Trajectory& world_from_lidar,
                               const MaskOptions& options);

}  // namespace dvi::objects
