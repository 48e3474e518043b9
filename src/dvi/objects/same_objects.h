#pragma once

#include <vector>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Tracks that hold mostly the same returns in most of the scans that see both, as one each: an object that was lost and found
/// again, or of which two parts were tracked. In the order of the first of each, as large as the largest.
std::vector<Track> without_duplicates(std::vector<Track> tracks);

}  // namespace dvi::objects
