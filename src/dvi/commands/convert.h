#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/datasets/reader.h"

namespace dvi::commands {

/// What `dvi convert` wrote.
struct ConvertReport {
  std::string format;
  std::vector<std::string> cameras;  ///< the drive's own first
  std::size_t images = 0, scans = 0;
  int first_frame = 0, last_frame = 0;
};

/// Writes a recording, or a range of it, in the `folder` layout: as its chosen camera saw it, and, where `all_cameras`, the
/// others too. Another camera that cannot be read is left out with a warning. InputError where the recording cannot be read, or
/// the folder is not empty.
ConvertReport convert(const fs::path& recording, const datasets::ReadOptions& read, bool all_cameras, const fs::path& out,
                      Progress& progress);

}  // namespace dvi::commands
