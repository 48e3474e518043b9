#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::datasets {

/// A dvi.toml to fill in, for images and scans of one's own.
struct DraftConfig {
  std::string text;
  std::vector<std::string> open;  ///< what is left to do, in words for a person
};

/// What can be found out of a folder with images/CAMERA and lidar/ or depth/: cameras, sizes, rates, the fields of the scans.
/// What cannot is commented out. InputError where it is a drive of another format, has a dvi.toml, or holds no images where the
/// `folder` layout has them, with what is there instead.
DraftConfig draft_config(const fs::path& folder);

}  // namespace dvi::datasets
