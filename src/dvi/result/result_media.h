#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/drive/drive.h"
#include "dvi/media/video.h"

namespace dvi::result {

/// video.mp4 (the result), compare.mp4 (the input, what is removed outlined, above the result, with name and shares) and
/// contact.png (frames spread over the drive, with crops of their holes) of the finished frames in a result folder.
void write_media(const fs::path& out, const Drive& target, const std::vector<std::string>& names,
                 const media::VideoOptions& options, Progress& progress);

}  // namespace dvi::result
