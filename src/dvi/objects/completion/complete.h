#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/camera_objects.h"
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
  SharedTracks tracks;         ///< the moving objects of the drive, whether masks show them or not
  const MaskOptions& options;  ///< of the masks of labels
  bool refine = true;          ///< whether the surroundings that bounding boxes cover are found
};

/// Outlines of objects in the frames of one camera. The track of a label is the number of its object.
struct ObjectOutlines {
  FrameLabels completed;   ///< per frame: the parts of objects that masks lack
  FrameLabels shown;       ///< per frame: the parts that masks show
  FrameLabels background;  ///< per frame: the surroundings that bounding boxes cover, behind and in front of all objects
};

/// The data of one object from which it is drawn.
struct CompletedObject {
  std::vector<OccupiedVoxel> voxels;  ///< the space that it occupied
  Eigen::AlignedBox3d extent;         ///< of the voxels, world axes
  std::vector<SharedTrack> tracks;    ///< its motion
  std::optional<LabeledBoxes> boxes;  ///< its labels
};

/// The objects of a drive in the world, to be drawn into its cameras.
class CompletedObjects {
 public:
  /// Finds the objects that masks or labels show in at least two frames: the labeled 3D boxes, the space that objects occupied
  /// (object_space.h), and the moving objects among the tracks. Calls `tick` once per scan.
  CompletedObjects(const CompletionInput& input, const Tick& tick);

  /// Draws the objects into the frames of a camera of the drive. The border of a mask counts as covered, so that correct masks
  /// remain as they are.
  ObjectOutlines draw(const CameraMaskEvidence& evidence) const;

  /// Returns the motion of the objects, by number.
  std::vector<ObjectMotion> motions() const;

  /// Returns the objects by number, and leaves none.
  std::map<int, CompletedObject> take() && { return std::move(objects_); }

 private:
  class FrameDrawing;

  const MovingReturns& returns_;
  const ground::ScanGround& ground_;
  MaskOptions options_;
  bool refine_;
  std::map<int, CompletedObject> objects_;  // by number: the track of its labels, or a higher number
};

}  // namespace dvi::objects
