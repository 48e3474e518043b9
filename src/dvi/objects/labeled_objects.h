#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/objects/camera_objects.h"
#include "dvi/objects/image_masks.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The objects that labels of points show in one drive.
struct LabeledTracks {
  SharedTracks tracks = share_tracks(std::vector<Track>());  ///< those of moving classes first
  std::size_t moving = 0;                                    ///< their number

  /// Returns the motion of all objects, by index. It is unknown if no object moves: such labels may not distinguish moving from
  /// stationary objects.
  std::vector<ObjectMotion> motions() const;
};

/// Tracks the labeled returns in the scans of a drive, whose own camera `own` is. Warns if there are none, or no poses.
LabeledTracks find_labeled_tracks(const CameraRef& own, const RemovalOptions& options, Progress& progress);

/// Draws these objects into the frames of a camera of the drive. Images continue the tracks of moving ones.
FrameLabels draw_labeled_tracks(const CameraRef& ref, const LabeledTracks& objects, const RemovalOptions& options);

}  // namespace dvi::objects
