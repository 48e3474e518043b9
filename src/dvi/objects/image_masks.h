#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/drive/label.h"
#include "dvi/objects/evidence.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// One camera among the evidence.
struct EvidenceOf {
  const Evidence& evidence;
  std::size_t index;

  const CameraEvidence& camera() const { return evidence[index]; }
  std::shared_ptr<const ground::ScanGround> ground() const { return evidence.ground(index); }
};

/// Labels of tracks that a drive's scans show (outlines(), from which `masks` are drawn), continued in the images of the camera
/// (image_following.h); both as its frames. The drive must have a ground.
FrameLabels continue_in_images(const EvidenceOf& of, const Lazy<cv::Mat1b>& masks, const SharedLabels& labels,
                               const std::vector<Track>& tracks);

/// What to look for in the images around masks.
struct ImageSearch {
  SharedLabels found;   ///< the masks are outlines of these, found in the scans: where images end them (silhouettes.h)
  bool shadows = true;  ///< cast by what is masked (shadows.h)
};

/// The masks of a camera after a comparison of each image with those of other times, on demand; a frame without pose keeps its
/// mask. The same masks, and a note, where the drive has no ground.
Lazy<cv::Mat1b> compare_images(const EvidenceOf& of, const Lazy<cv::Mat1b>& masks, const ImageSearch& search,
                               Progress& progress);

}  // namespace dvi::objects
