#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/labels/mask_reading.h"

namespace dvi::labels {

/// Replaces the masks of an open drive by the frames of a video, whose frame n is the mask of the n-th recorded image, from 0;
/// a video with as many frames as the drive has selected frames shows these. Pixels of at least half the brightness are white,
/// because videos are compressed. Throws InputError if the number of frames or their size differs from that of the images.
void attach_mask_video(Drive& drive, const fs::path& file);

/// Applies the rules to the masks of drive.mask_video. Throws UsageError for rules about classes.
void read_mask_video(Drive& drive, const MaskReading& reading);

}  // namespace dvi::labels
