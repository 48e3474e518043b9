#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::labels {

/// The images that the names in a label file or of mask files belong to.
struct MatchedNames {
  std::vector<std::optional<std::string>> images;  ///< the name of the image per given name; none if there is no such image
  std::optional<std::string> warning;              ///< the rule by which the names were matched, unless they are equal
};

/// Matches names without folder and extension to those of the recorded images, in three steps. First, equal names match. If no
/// name is equal, additions of tools are removed: NAME_mask, NAME.jpg, NAME_png.rf.HASH (Roboflow), HASH-NAME (Label Studio),
/// frame_NAME (CVAT), NAME_gtFine_labelIds and NAME_leftImg8bit (Cityscapes). If still no name is equal and all names end in
/// numbers of the images, equal numbers match: 7 matches 000007.
///
/// Throws InputError about `source` if the names count from 1 and the images from 0 or the other way around, because equal
/// numbers may then belong to different images, or if two names match the same image in the second or third step.
MatchedNames match_names(const fs::path& source, const std::vector<std::string>& names, const std::set<std::string>& recorded);

/// Describes a set of names by its first and last one, for messages: "000000 to 000019".
std::string span_of(const std::set<std::string>& names);

}  // namespace dvi::labels
