#pragma once

#include <map>
#include <memory>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/inputs/poses.h"
#include "dvi/objects/tracks.h"

namespace dvi::inputs {

/// What to look for in the images round masks.
struct Compared {
  SharedLabels found;   ///< where the masks are outlines of these, found in the scans: how the images end them
  bool shadows = true;  ///< cast by what is masked
};

/// The ground of each drive, which its cameras share: made when it is first asked for. `drives` and `poses` must outlive this.
class Grounds {
 public:
  Grounds(const Recordings& drives, const Poses& poses) : drives_(drives), poses_(poses) {}
  /// None without poses or scans.
  std::shared_ptr<const ground::ScanGround> of(std::size_t recording) const;

 private:
  const Recordings& drives_;
  const Poses& poses_;
  mutable std::map<std::size_t, std::shared_ptr<const ground::ScanGround>> made_;  // by drive
};

/// Labels of tracks that a drive's scans show (traffic::outlines(), which `masks` are drawn from), continued in its images;
/// both as its frames.
FrameLabels seen_in_images(const Drive& drive, const Trajectory& world_from_lidar, const SharedLabels& labels,
                           const std::vector<objects::Track>& tracks, const Lazy<cv::Mat1b>& masks,
                           const std::shared_ptr<const ground::ScanGround>& ground);

/// A drive's masks after a comparison of each image with those of other times (traffic/silhouettes.h, traffic/shadows.h), on
/// demand; a frame without pose keeps its mask. The same masks, and a note, where the drive has no ground.
Lazy<cv::Mat1b> compared(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                         const Compared& what, const std::shared_ptr<const ground::ScanGround>& ground, Progress& progress);

}  // namespace dvi::inputs
