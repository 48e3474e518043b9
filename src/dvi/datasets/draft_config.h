#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::datasets {

/// A draft of dvi.toml for the user's own images and scans.
struct DraftConfig {
  std::string text;
  std::vector<std::string> open;  ///< the remaining tasks, as text for the user
};

/// Drafts dvi.toml for a folder with images/CAMERA and lidar/ or depth/. Finds cameras, sizes, rates, and the fields of the
/// scans; entries that cannot be determined are commented out. Throws InputError if the folder is a drive of another format,
/// has a dvi.toml already, or holds no images where the `folder` layout has them.
DraftConfig draft_config(const fs::path& folder);

}  // namespace dvi::datasets
