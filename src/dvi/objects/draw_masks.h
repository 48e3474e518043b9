#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/find_objects.h"

namespace dvi::objects {

/// What is removed from the images of one camera.
struct CameraMasks {
  Lazy<cv::Mat1b> images;  ///< as the drive's frames; 255 = remove
  SharedLabels objects;    ///< labels of what is removed, as the drive's frames
};

/// As the cameras of the evidence.
using Masks = std::vector<CameraMasks>;

/// The masks of all cameras: mask files, or drawn from `objects`, with the shadows beside them where poses and scans allow to
/// find these. Masks of objects that were found in scans end where the images show the background.
Masks draw_masks(const Evidence& evidence, const Objects& objects, const RemovalOptions& options, Progress& progress);

/// Finds the objects and draws their masks.
Masks find_and_draw(const Evidence& evidence, const RemovalOptions& options, Progress& progress);

/// The masks of one camera as mask files and labels give them: nothing that the program itself has to find.
struct GivenMasks {
  Lazy<cv::Mat1b> images;  ///< as the drive's frames; 255 = remove
  bool complete = false;   ///< whether a run masks no more than that
};

/// As the cameras of the evidence.
std::vector<GivenMasks> draw_given_masks(const Evidence& evidence, const RemovalOptions& options);

/// The masks of one camera without its ego mask, without shadows, and without what images show: those of its mask files, or of
/// `objects` (as its frames).
Lazy<cv::Mat1b> draw_object_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options);

/// The same with the ego mask; the ego mask only where nothing else is removed.
Lazy<cv::Mat1b> draw_plain_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options);

/// The labels of what is removed where labels say so: those of the drive, or, to remove moving objects only, those of them that
/// are not stationary.
FrameLabels removed_labels(const CameraEvidence& evidence, const RemovalOptions& options);

}  // namespace dvi::objects
