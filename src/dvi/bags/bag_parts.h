#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::bags {

/// A missing file of a split recording.
struct MissingPart {
  std::string name;
  std::size_t position = 0;  ///< the number of existing files before it
};

/// The files of a recording, which may be split by size or duration.
struct BagParts {
  std::vector<fs::path> files;                ///< the existing files in order
  std::vector<MissingPart> missing;           ///< in order
  std::map<std::string, std::size_t> counts;  ///< messages of each topic in the whole recording; empty if unknown
  std::vector<std::string> warnings;
};

/// Returns whether a file is a bag by its ending: .mcap, .db3 or .bag.
bool has_bag_ending(const fs::path& file);

/// Finds the files of a bag. Those of a folder are ordered by its metadata.yaml or, without one, by the numbers at the end of
/// their names. Adds warnings about missing files and about a single file that is part of a recording. Throws InputError if
/// none of the listed files exists or if a file is compressed as a whole.
BagParts find_bag_parts(const fs::path& path);

}  // namespace dvi::bags
