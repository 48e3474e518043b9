#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::labels {

/// Which images the names in a label file, or of mask files, belong to.
struct MatchedNames {
  std::vector<std::optional<std::string>> images;  ///< one per given name: the name of its image; none if it has none
  std::optional<std::string> warning;              ///< how the names were matched, unless they are equal
};

/// Matches names without folder and extension to those of the recorded images. Equal names belong together. If no name is
/// equal, what tools add to names is left out: NAME_mask, NAME.jpg, NAME_png.rf.HASH (Roboflow), HASH-NAME (Label Studio),
/// frame_NAME (CVAT), NAME_gtFine_labelIds and NAME_leftImg8bit (Cityscapes). If no name is equal then either, and all names
/// end in numbers of the images, numbers belong together: 7 to 000007.
///
/// Throws InputError of `source` if the names count from 1 what the images count from 0, or the other way around, because equal
/// numbers may then belong to different images; or if two names have the same image in the second or third step.
MatchedNames match_names(const fs::path& source, const std::vector<std::string>& names, const std::set<std::string>& recorded);

/// Describes a set of names by its ends, for messages: "000000 to 000019".
std::string span_of(const std::set<std::string>& names);

}  // namespace dvi::labels
