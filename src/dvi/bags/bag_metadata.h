#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::bags {

/// The parts of a ROS 2 recording as described by rosbag2 in metadata.yaml.
struct BagMetadata {
  std::vector<std::string> files;             ///< names without folders, in order
  std::map<std::string, std::size_t> counts;  ///< messages of each topic in all files; empty if not stated
};

/// Returns whether a folder has a metadata.yaml of rosbag2.
bool has_bag_metadata(const fs::path& folder);

/// Reads FOLDER/metadata.yaml. Returns nothing if the folder has no such file of rosbag2. Throws InputError if the file is too
/// large.
std::optional<BagMetadata> read_bag_metadata(const fs::path& folder);

}  // namespace dvi::bags
