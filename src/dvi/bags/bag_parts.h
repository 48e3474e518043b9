#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::bags {

/// A file of a split recording that is not there.
struct MissingPart {
  std::string name;
  std::size_t position = 0;  ///< how many of the files that are there come before it
};

/// The files of a recording, which recorders split by size or duration.
struct BagParts {
  std::vector<fs::path> files;                ///< those that are there, in order
  std::vector<MissingPart> missing;           ///< in order
  std::map<std::string, std::size_t> counts;  ///< messages of each topic in the whole recording; empty where unknown
  std::vector<std::string> warnings;
};

/// Whether a file is a bag by the ending of its name: .mcap, .db3 or .bag.
bool has_bag_ending(const fs::path& file);

/// The files of a bag: of a folder all its bags, in the order of its metadata.yaml, or without one by the numbers at the end of
/// their names; of a single file that file. Warns of files that are missing, and of a single file that is part of a recording.
/// InputError where a folder names bags and has none of them, and where a file is compressed as a whole.
BagParts find_bag_parts(const fs::path& path);

}  // namespace dvi::bags
