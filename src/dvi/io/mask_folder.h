#pragma once

#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::io {

/// The PNG masks of folders as `frames`, tied by NAME; an empty path where a frame has none; an empty list where there are no
/// masks. Masks of images that are missing between the first and the last are left alone; InputError where a file belongs to
/// neither.
std::vector<fs::path> match_masks(const std::vector<Frame>& frames, const std::vector<fs::path>& folders);

/// Gives an open drive the masks of a folder instead of its own. The drive may have been cut: masks of other frames are left
/// alone. InputError where none belongs to a frame.
void attach_masks(Drive& drive, const fs::path& folder);

}  // namespace dvi::io
