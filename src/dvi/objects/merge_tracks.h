#pragma once

#include <vector>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Merges tracks that have most of their returns in common in most of the scans that observe both: tracks of an object that was
/// lost and found again, or of two parts of one object. The order is that of the first track of each object. A merged track has
/// the largest height and size of its parts.
std::vector<Track> merge_duplicates(std::vector<Track> tracks);

}  // namespace dvi::objects
