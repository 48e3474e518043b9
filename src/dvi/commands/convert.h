#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/datasets/reader.h"

namespace dvi::commands {

/// The recording, or the part of it, to convert.
struct ConvertSource {
  fs::path recording;
  datasets::ReadOptions read;
  bool all_cameras = true;  ///< also convert the cameras that `read` does not choose
};

/// The contents of a converted drive.
struct ConvertReport {
  std::string format;
  std::vector<std::string> cameras;  ///< the drive's own first
  std::size_t images = 0, scans = 0;
  int first_frame = 0, last_frame = 0;
};

/// Writes a recording, or a range of it, in the `folder` layout. Another camera that cannot be read is left out with a warning.
/// Throws InputError if the recording cannot be read, or if the folder is not empty.
ConvertReport convert(const ConvertSource& source, const fs::path& out, Progress& progress);

}  // namespace dvi::commands
