#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/drive/label.h"
#include "dvi/inputs/compared_masks.h"
#include "dvi/inputs/poses.h"

namespace dvi::inputs {

/// Labels of what is removed, for each recording as its frames.
using Objects = std::vector<SharedLabels>;

/// What is removed from one drive.
struct DriveMasks {
  Lazy<cv::Mat1b> images;  ///< as the drive's frames; 255 = remove
  SharedLabels objects;    ///< labels of what is removed, as the drive's frames
};

/// As the recordings.
using Masks = std::vector<DriveMasks>;

/// The objects to remove from each drive, as the job asks: those labeled, without those that stand along `poses` if it wants
/// moving ones only; what its detector sees, tracked over time; or what moves, where a drive brings neither masks nor labels. A
/// warning says where it cannot be told what stands, so that nothing is left in the picture.
Objects find_objects(const Recordings& drives, const Poses& poses, const Grounds& grounds, const job::Job& job,
                     Progress& progress);

/// The masks of the drives: files, or drawn from `objects`, and the shadows beside them where the poses allow to find them.
Masks find_masks(const Recordings& drives, const Poses& poses, const Grounds& grounds, const Objects& objects,
                 const job::Job& job, Progress& progress);
inline Masks find_masks(const Recordings& drives, const Poses& poses, const job::Job& job, Progress& progress) {
  const Grounds grounds(drives, poses);
  return find_masks(drives, poses, grounds, find_objects(drives, poses, grounds, job, progress), job, progress);
}

/// Removed tracks of a drive that stand, as masks::standing_tracks says.
struct StandingTracks {
  std::size_t tracks = 0, standing = 0;  ///< removed tracks; those of them that stand
  std::size_t pixels = 0;                ///< of the hole, that `--remove moving` would not remove
};

/// What the job removes of a drive although it stands; none where the masks do not say what stands.
std::optional<StandingTracks> standing_tracks(const Recording& open, const Trajectory& world_from_lidar, const job::Job& job);

}  // namespace dvi::inputs
