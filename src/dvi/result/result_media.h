#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"
#include "dvi/media/video.h"

namespace dvi::result {

/// Writes videos and a contact sheet of the finished frames in a result folder: video.mp4 (the result), compare.mp4 (the input
/// with outlines of the holes, name, and shares, above the result), and contact.png (frames spread over the drive, with crops
/// of their holes).
void write_media(const fs::path& out, const Drive& target, const std::vector<std::string>& names,
                 const media::VideoOptions& options, Progress& progress);

}  // namespace dvi::result
