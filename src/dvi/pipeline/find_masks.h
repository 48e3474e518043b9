#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/drive/label.h"
#include "dvi/pipeline/poses.h"

namespace dvi::pipeline {

/// What is removed from one drive.
struct DriveMasks {
  Lazy<cv::Mat1b> images;  ///< as the drive's frames; 255 = remove
  FrameLabels objects;     ///< labels of what is removed, as the drive's frames
};

/// As the recordings.
using Masks = std::vector<DriveMasks>;

/// Decides what is removed from each drive, as the job asks. Which labelled objects stand is decided along `poses`;
/// a warning says where that cannot be told, so that nothing is left in the picture.
Masks find_masks(const Recordings& drives, const Poses& poses, const Job& job, Progress& progress);

/// Removed tracks of a drive that stand, as masks::standing_tracks says.
struct StandingTracks {
  std::size_t tracks = 0, standing = 0;  ///< removed tracks; those of them that stand
  std::size_t pixels = 0;                ///< of the hole, that `--remove moving` would not remove
};

/// What the job removes of a drive although it stands; none where the masks do not say what stands.
std::optional<StandingTracks> standing_tracks(const Recording& open, const Trajectory& world_from_lidar, const Job& job);

}  // namespace dvi::pipeline
