#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/find_objects.h"

namespace dvi::objects {

/// The masks and the removed objects of one camera.
struct CameraMasks {
  Lazy<cv::Mat1b> images;   ///< per frame of the drive; 255 = remove
  CameraObjects objects{};  ///< the removed objects
  /// Per frame of a cleaned camera: 255 where its objects are unknown, which is neither removed nor copied from; empty: all are
  /// known. Other cameras have these pixels in `images`.
  Lazy<cv::Mat1b> unknown{};
};

/// Masks per camera of the evidence.
using Masks = std::vector<CameraMasks>;

/// Draws the masks of all cameras: the union of mask files and `objects`, with the shadows beside them if poses and scans are
/// available. Masks from motion segmentation are refined in the images.
Masks draw_masks(const Evidence& evidence, const Objects& objects, const RemovalOptions& options, Progress& progress);

/// Finds the objects and draws their masks.
Masks find_and_draw(const Evidence& evidence, const RemovalOptions& options, Progress& progress);

/// The masks that follow from mask files and labels alone, without searches in scans or images and without estimated poses. A
/// run may extend them.
struct GivenMasks {
  Masks masks;            ///< without labels of objects
  bool complete = false;  ///< whether a run uses exactly these masks for the own camera of the target
  bool refined = false;   ///< whether a run may remove less than these masks
};

/// Draws the given masks of all cameras.
GivenMasks draw_given_masks(const Evidence& evidence, const RemovalOptions& options);

/// Draws the masks of one camera from its mask files and from `objects` (per frame), without ego mask, shadows, and refinement
/// in the images.
Lazy<cv::Mat1b> draw_object_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options);

/// Draws the same masks with the ego mask. If the camera has no mask source, the ego mask is all that is removed.
Lazy<cv::Mat1b> draw_plain_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options);

/// Returns the labels of the removed objects, if labels define them: all labels of the drive or, with Remove::moving, those
/// that are not stationary. Tracks that end at the image border are extended.
FrameLabels select_removed_labels(const CameraEvidence& evidence, const RemovalOptions& options);

/// Returns the labels without a 3D box, which the masks of their camera only show.
FrameLabels select_unboxed(FrameLabels labels);

}  // namespace dvi::objects
