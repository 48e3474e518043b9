#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The input of a search for objects, which all of its parts share.
struct SearchInput {
  const Evidence& evidence;
  const RemovalOptions& options;
  Progress& progress;
};

/// The returns of one drive and the objects that move in them.
struct DriveMotion {
  std::shared_ptr<const ground::ScanGround> ground;  ///< null without poses or scans
  std::shared_ptr<MovingReturns> returns;            ///< null without ground
  SharedTracks tracks;                               ///< never null
};

/// The moving objects of all drives, each segmented at the first call.
class MovingObjects {
 public:
  explicit MovingObjects(const SearchInput& input)
      : evidence_(input.evidence), options_(input.options), progress_(input.progress) {}

  /// Returns the motion in the drive whose own camera this is; without tracks if it has no poses or scans.
  const DriveMotion& of_drive(std::size_t camera);

  /// Draws the outlines of the moving objects into the images of a camera of the drive.
  FrameLabels draw_outlines_in(std::size_t camera);

  /// Finds the moving objects in the frames of the camera with this index, by the scans and the images.
  FrameLabels find_in(std::size_t index);

 private:
  DriveMotion find(std::size_t camera);

  const Evidence& evidence_;
  const RemovalOptions& options_;
  Progress& progress_;
  std::map<std::size_t, DriveMotion> drives_;  // by own camera
};

}  // namespace dvi::objects
