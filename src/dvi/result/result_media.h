#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/media/video.h"

namespace dvi::result {

/// The finished frames of one camera in a result folder, in the order of the drive, and the options of their videos.
struct FinishedFrames {
  fs::path out;
  std::vector<std::string> names;
  cv::Size size;
  std::function<cv::Mat3b(std::size_t)> read_input;  ///< returns the input of the i-th frame; called from several threads
  media::VideoOptions options;
};

/// Writes videos and a contact sheet, beside the folder of the frames: video.mp4 (the result), compare.mp4 (the input with
/// outlines of the holes, name, and shares, above the result), and contact.png (frames spread over the drive, with crops of
/// their holes). Encodes the segments that are not stored. Calls `tick` once per frame.
void write_media(const FinishedFrames& frames, const Tick& tick);

/// Encodes the segments of the videos that contain frames of `filled`, and stores them for write_media() (SegmentStore). Leaves
/// out segments with frames that are not finished.
void store_segments(const FinishedFrames& frames, const std::set<std::string>& filled, const Tick& tick);

}  // namespace dvi::result
