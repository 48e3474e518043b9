#pragma once

#include <vector>

#include "dvi/drive/label.h"
#include "dvi/pipeline/poses.h"

namespace dvi::pipeline {

/// What is removed from one drive.
struct DriveMasks {
  Lazy<cv::Mat1b> images;  ///< as the drive's frames; 255 = remove
  FrameLabels objects;     ///< labels of what is removed, as the drive's frames
};

/// As the recordings.
using Masks = std::vector<DriveMasks>;

/// Decides what is removed from each drive, as the job asks. Which labelled objects stand is decided along `poses`;
/// a warning says where that cannot be told, so that nothing is left in the picture.
Masks find_masks(const Recordings& drives, const Poses& poses, const Job& job, Progress& progress);

}  // namespace dvi::pipeline
