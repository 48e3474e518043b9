#pragma once

#include <cstdint>
#include <vector>

#include "dvi/drive/label.h"

namespace dvi::objects {

/// The motion of an object during the drive. moving: it moves at any time.
enum class MotionState : std::uint8_t { unknown, stationary, moving };

struct ObjectMotion {
  int object = -1;  ///< its number
  MotionState state = MotionState::unknown;
};

/// The removed objects in the frames of one camera. The track of a label is the number of its object.
struct CameraObjects {
  SharedLabels labels;                  ///< labels of the objects, per frame
  SharedLabels completed;               ///< outlines of the parts of objects that the masks lack, per frame
  SharedLabels shown;                   ///< outlines of the parts of completed objects that the masks show, per frame
  SharedLabels background;              ///< outlines of the surroundings that bounding boxes cover, per frame
  std::vector<ObjectMotion> motions{};  ///< of the objects whose motion is known, by number

  /// Makes objects that only have labels.
  explicit CameraObjects(SharedLabels of_frames = shared({}))
      : labels(std::move(of_frames)), completed(shared(FrameLabels(labels->size()))), shown(completed), background(completed) {}
};

}  // namespace dvi::objects
