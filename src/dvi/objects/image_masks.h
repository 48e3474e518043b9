#pragma once

#include <cstddef>
#include <span>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// One camera of the evidence.
struct CameraRef {
  const Evidence& evidence;
  std::size_t index;

  const CameraEvidence& camera() const { return evidence[index]; }
  std::shared_ptr<const ground::ScanGround> ground() const { return evidence.ground(index); }
};

/// Continues the labels of tracks that a drive's scans show (draw_outlines(), from which `masks` are drawn) in the images of
/// the camera (image_tracking.h). Masks and labels are per frame. The drive must have a ground.
FrameLabels extend_in_images(const CameraRef& ref, const Lazy<cv::Mat1b>& masks, const SharedLabels& labels,
                             std::span<const Track> tracks);

/// The refinements of masks by a comparison of images.
struct MaskRefinement {
  /// The objects whose outlines the masks are, to be refined to silhouettes (silhouettes.h); null: no refinement.
  SharedLabels outlined;
  bool shadows = true;  ///< whether shadows of the masked objects are added (shadows.h)
};

/// Refines the masks of a camera by a comparison of each image with the background model, on demand. A frame without a pose
/// keeps its mask. If the drive has no ground, returns the masks unchanged and adds a note.
Lazy<cv::Mat1b> refine_masks(const CameraRef& ref, const Lazy<cv::Mat1b>& masks, const MaskRefinement& refinement,
                             Progress& progress);

}  // namespace dvi::objects
