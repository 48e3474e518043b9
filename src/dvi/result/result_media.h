#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/media/video.h"

namespace dvi::result {

/// The frames of one camera in a finished result, in the order of the drive.
struct FinishedFrames {
  std::vector<std::string> names;
  cv::Size size;
  std::function<cv::Mat3b(std::size_t)> read_input;  ///< returns the input of the i-th frame; called from several threads
};

/// Writes videos and a contact sheet of the finished frames in a result folder: video.mp4 (the result), compare.mp4 (the input
/// with outlines of the holes, name, and shares, above the result), and contact.png (frames spread over the drive, with crops
/// of their holes), beside the folder of the frames. Calls `tick` once per frame.
void write_media(const fs::path& out, const FinishedFrames& frames, const media::VideoOptions& options, const Tick& tick);

}  // namespace dvi::result
