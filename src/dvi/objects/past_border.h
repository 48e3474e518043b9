#pragma once

#include "dvi/drive/drive.h"
#include "dvi/objects/label_masks.h"

namespace dvi::objects {

/// `labels` (as the drive's frames), and the boxes of tracks that end where the image's border cuts them: labels often leave
/// out what shows less than a part of an object. A box moves on as it moved last, in the world or, without poses, in LiDAR
/// axes, for a second at most and while the image shows it; likewise backwards from a track's first frame.
FrameLabels continued_past_border(const Drive& drive, FrameLabels labels, const Trajectory& world_from_lidar,
                                  const MaskOptions& options);

}  // namespace dvi::objects
