#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/completion/labeled_boxes.h"
#include "dvi/objects/completion/masked_returns.h"
#include "dvi/objects/completion/object_space.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The data of one drive from which its removed objects are completed.
struct CompletionInput {
  std::vector<CameraMaskEvidence> cameras;  ///< the cameras of the drive that have masks of their own
  const MovingReturns& returns;
  const ground::ScanGround& ground;
  const std::vector<Track>& tracks;  ///< the moving objects of the drive, whether masks show them or not
  const MaskOptions& options;        ///< of the masks of labels
};

/// The objects of a drive in the world, to be drawn into its cameras.
class CompletedObjects {
 public:
  /// Finds the objects that masks or labels show in at least two frames: the labeled 3D boxes, the space that objects occupied
  /// (object_space.h), and the moving objects among the tracks. Calls `tick` once per scan.
  CompletedObjects(const CompletionInput& input, const std::vector<std::int64_t>& scan_times_ns, const Tick& tick);

  /// Draws the objects into the frames of a camera of the drive where `masks` (per frame) do not cover them: labels with an
  /// outline of the uncovered part. The border of a mask counts as covered, so that correct masks remain as they are.
  FrameLabels draw(const CameraEvidence& camera, const Lazy<cv::Mat1b>& masks) const;

 private:
  std::vector<Label> draw_frame(const CameraEvidence& camera, std::size_t frame, const cv::Mat1b& mask) const;

  const MovingReturns& returns_;
  const ground::ScanGround& ground_;
  std::vector<std::int64_t> scan_times_ns_;
  MaskOptions options_;
  std::vector<OccupiedVoxel> space_;
  std::vector<Track> tracks_;          // of removed objects
  std::vector<LabeledBoxes> labeled_;  // of the labels of the drive's cameras
};

}  // namespace dvi::objects
